// A trial's result as a file of other programs: a choice of formats, each a download.
"use strict";

const EXPORTS = ["c3d", "csv", "bvh", "glb", "mp4", "gif"];

function exportSelect(data, one) {
  const idle = element("option", { value: "" }, word("export"));
  const select = element("select", { className: "export" }, idle, ...EXPORTS.map((name) => element("option", { value: name }, word(name))));
  select.setAttribute("aria-label", word("export_as", one.name));
  select.onchange = async () => {
    const to = select.value, file = `${one.name}.${to}`;
    [select.value, select.disabled, idle.textContent] = ["", true, `${to} …`]; // a film takes its time
    tell(word("exporting", file));
    await download("trial/export?" + query({ session: data.id, trial: one.name, to }), file);
    [select.disabled, idle.textContent] = [false, word("export")];
  };
  return select;
}

async function download(path, file) {
  const still = here(), answer = await fetch(path).catch(() => null);
  if (answer === null || !answer.ok) {
    const trouble = answer === null ? word("lost") : (await answer.json()).trouble;
    if (still()) tell(trouble, true);
    return;
  }
  const address = URL.createObjectURL(await answer.blob());
  element("a", { href: address, download: file }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60000);
  if (still()) tell(word("exported", file));
}
