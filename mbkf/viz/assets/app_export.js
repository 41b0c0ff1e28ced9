// A trial's result as a file of other programs: a choice of formats, each a download.
"use strict";

const EXPORTS = ["c3d", "bvh", "glb", "mp4", "gif"];

function exportSelect(data, one) {
  const select = element("select", { className: "export" }, element("option", { value: "" }, word("export")), ...EXPORTS.map((name) => element("option", { value: name }, word(name))));
  select.setAttribute("aria-label", word("export_as", one.name));
  select.onchange = () => {
    const to = select.value;
    select.value = "";
    exportTrial(data.id, one.name, to);
  };
  return select;
}

async function exportTrial(session, trial, to) {
  const file = `${trial}.${to}`;
  tell(word("exporting", file));
  const answer = await fetch("trial/export?" + query({ session, trial, to })).catch(() => null);
  if (answer === null || !answer.ok) {
    tell(answer === null ? word("lost") : (await answer.json()).trouble, true);
    return;
  }
  const address = URL.createObjectURL(await answer.blob());
  element("a", { href: address, download: file }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60000);
  tell(word("exported", file));
}
