// Distinguishes programs by colour (common/experiment/program_colours.hpp chooses it), letter and
// symbol.

const SYMBOLS = ["circle", "square", "triangle-up", "diamond", "triangle-down", "cross"];
const NONE = {
  name: "no program",
  color: "#8C8C8C",
  ink: "#000",
  letter: "",
  symbol: "circle"
};

let programs = [];

/** Black or white, for text on a colour "#0072B2". */
function inkOn(rgb) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(rgb.slice(at, at + 2), 16));
  return 0.299 * red + 0.587 * green + 0.114 * blue < 128 ? "#fff" : "#000";  // luma of BT.601
}

/** @param list the programs of topic `lab` */
export function setPrograms(list) {
  const taken = new Set();
  programs = list.map((program) => {
    const free = [...program.name.toUpperCase(), ..."ABCDEFGHIJKLMNOPQRSTUVWXYZ"].find(
                     (letter) => /[\p{L}\p{N}]/u.test(letter) && !taken.has(letter)) ??
        "?";
    taken.add(free);
    return {
      ...program,
      color: program.rgb,
      ink: inkOn(program.rgb),
      letter: free,
      symbol: SYMBOLS[program.color % SYMBOLS.length],
    };
  });
}

export const allPrograms = () => programs;

/** The program by its index in lab.programs, -1: none. */
export const programAt = (place) => programs[place] ?? NONE;

export const programNamed = (name) =>
    programs.find((program) => program.name === name) ?? {...NONE, name: name ?? NONE.name};
