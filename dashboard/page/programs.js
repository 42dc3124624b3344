// Distinguishes programs by colour (Okabe and Ito's palette, safe for colour-blind readers), letter
// and symbol.

const COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8C8C8C"];
const INKS = ["#fff", "#fff", "#fff", "#000", "#000", "#000", "#000"];  // text colours on them
const SYMBOLS = ["circle", "square", "triangle-up", "diamond", "triangle-down", "cross"];
const NONE = {
  name: "no program",
  color: "#8C8C8C",
  ink: "#000",
  letter: "",
  symbol: "circle"
};

let programs = [];

/** @param list the programs of topic `lab` */
export function setPrograms(list) {
  const taken = new Set();
  programs = list.map((program, place) => {
    const number = program.color ?? place;
    const free = [...program.name.toUpperCase(), ..."ABCDEFGHIJKLMNOPQRSTUVWXYZ"].find(
                     (letter) => /[\p{L}\p{N}]/u.test(letter) && !taken.has(letter)) ??
        "?";
    taken.add(free);
    return {
      ...program,
      color: COLORS[number % COLORS.length],
      ink: INKS[number % INKS.length],
      letter: free,
      symbol: SYMBOLS[number % SYMBOLS.length],
    };
  });
}

export const allPrograms = () => programs;

/** The program by its index in lab.programs, -1: none. */
export const programAt = (place) => programs[place] ?? NONE;

export const programNamed = (name) =>
    programs.find((program) => program.name === name) ?? {...NONE, name: name ?? NONE.name};
