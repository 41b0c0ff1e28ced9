// A trial's result as a file of other programs: a choice of formats, each a download.
"use strict";

const EXPORTS = ["c3d", "csv", "bvh", "glb", "mp4", "gif"];

function exportMenu(data, one) {
  const entry = (to) => [word(to), async () => {
    const file = `${one.name}.${to}`;
    tell(word("exporting", file)); // a film takes its time
    await download("trial/export?" + query({ session: data.id, trial: one.name, to }), file);
  }];
  return menu(word("export"), word("export_as", one.name), EXPORTS.map(entry));
}

async function download(path, file) {
  const still = here(), answer = await fetch(path).catch(() => null);
  if (answer === null || !answer.ok) {
    const trouble = answer === null ? word("lost") : troubleOf(await answer.json());
    if (still()) tell(trouble, true);
    return;
  }
  const address = URL.createObjectURL(await answer.blob());
  element("a", { href: address, download: file }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60000);
  if (still()) tell(word("exported", file));
}
