// The page's words in each language; a word that a language lacks is an error that a test finds.
"use strict";

const WORDS = {
  en: {
    language: "Language", drop: "Drop a session's folder or its files here", choose_folder: "Choose a folder", choose_files: "Choose files",
    no_session: "Nothing here yet: drop a folder with captures on the left.", person: "Person", name: "Name or code", mass: "Mass, kg",
    height: "Height, m", sex: "Sex", age: "Age", female: "female", male: "male", other: "other", unknown_sex: "not stated",
    bear: "the plates bear {0} kg", take: "Take it", trials: "Trials", trial: "Trial", kind: "What it is", length: "Length",
    markers: "Markers", plates: "Plates", use: "Use", why: "Why not", problems: "What is the matter", result: "Result", look: "3-D",
    report: "Report", run: "Run", again: "Run again", cancel: "Cancel", close: "Close", remaining: "about {0} left", saved: "Saved",
    of: "{0} of {1} trials", scaling: "The body is scaled", waiting: "Waiting for another session", finished: "Done in {0}",
    cancelled: "Cancelled; what is done is kept", failed_run: "It could not be run: {0}", uploaded: "{0} files taken", uploading: "{0} of {1} files",
    static: "standing", walk: "walk", run_kind: "run", squat: "squat", jump: "jump", unknown: "unknown", done: "done", unchanged: "done",
    failed: "failed", seconds: "{0} s", minutes: "{0} min", lost: "The page's server does not answer; start mbkf app again.",
  },
  es: {
    language: "Idioma", drop: "Suelte aquí la carpeta de una sesión o sus archivos", choose_folder: "Elegir carpeta", choose_files: "Elegir archivos",
    no_session: "Todavía no hay nada: suelte a la izquierda una carpeta con capturas.", person: "Persona", name: "Nombre o código", mass: "Masa, kg",
    height: "Estatura, m", sex: "Sexo", age: "Edad", female: "femenino", male: "masculino", other: "otro", unknown_sex: "no indicado",
    bear: "las plataformas soportan {0} kg", take: "Tomarla", trials: "Ensayos", trial: "Ensayo", kind: "Qué es", length: "Duración",
    markers: "Marcadores", plates: "Plataformas", use: "Usar", why: "Por qué no", problems: "Qué ocurre", result: "Resultado", look: "3-D",
    report: "Informe", run: "Calcular", again: "Calcular de nuevo", cancel: "Cancelar", close: "Cerrar", remaining: "faltan unos {0}", saved: "Guardado",
    of: "{0} de {1} ensayos", scaling: "Se escala el cuerpo", waiting: "En espera de otra sesión", finished: "Listo en {0}",
    cancelled: "Cancelado; lo calculado se conserva", failed_run: "No se pudo calcular: {0}", uploaded: "{0} archivos recibidos", uploading: "{0} de {1} archivos",
    static: "de pie", walk: "marcha", run_kind: "carrera", squat: "sentadilla", jump: "salto", unknown: "desconocido", done: "listo", unchanged: "listo",
    failed: "fallido", seconds: "{0} s", minutes: "{0} min", lost: "El servidor de la página no responde; inicie de nuevo mbkf app.",
  },
};

let language = localStorage.getItem("mbkf language") || (navigator.language.startsWith("es") ? "es" : "en");

function word(name, ...values) {
  const text = (WORDS[language] || WORDS.en)[name];
  return values.reduce((said, value, k) => said.replace(`{${k}}`, value), text);
}

function duration(seconds) {
  return seconds < 90 ? word("seconds", Math.max(1, Math.round(seconds))) : word("minutes", Math.round(seconds / 60));
}
