// What mouse, keys and pads do, in a dialog.
import { get, make } from "./dom";

const helpRows: [string, string][] = [
  ["Drag the orange part", "take it by a spring; what it touches pushes back; the part of another hand likewise"],
  ["Shift + drag, or Turn", "turn it about its handle"],
  ["Wheel while dragging", "farther and nearer"],
  ["Letting go", "the part stays where the hand was; R starts again with the scripted hand"],
  ["Arrows, page up and down", "fine steps (shift turns, alt is finer) when the scene has the focus"],
  ["G", "the device's button: grasp"],
  ["SpaceMouse, gamepad", "lead the hand as long as they are deflected; a gamepad rumbles while the part pushes"],
  ["Drag beside it, wheel, right drag", "look around, zoom to the pointer, shift the view; a double click becomes the middle"],
  ["1 2 3 4, the cube", "slanted, front, side, top; a face of the cube"],
  ["P, E, X, T, F", "pieces, kinds of edges, glass (parts that hide a held one, all, none), trail, force fields"],
  ["+ −", "longer, shorter arrows; without that one newton has the same length in every moment"],
  ["W, N", "the raw wrench beside the shown one, energy charts"],
  ["Space, then Enter", "STOP: force and torque are led to zero at once; feel again"],
  ["V", "record the run into a file; end it"],
  ["Space, comma, full stop", "of a recording: play and pause, a frame back, a frame on"],
  ["C, click on a chart", "pause; show that moment"],
  ["L, R", "back to now; start again"],
];
export function showHelp(on: boolean) {
  const help = get<HTMLDialogElement>("help");
  if (!on) return help.close();
  if (help.childElementCount === 0) fillHelp(help);
  help.showModal();
  get("help-button").setAttribute("aria-expanded", "true");
}
function fillHelp(help: HTMLDialogElement) {
  const close = make("button", { "aria-label": "Close" }, "×");
  close.onclick = () => showHelp(false);
  help.onclose = () => get("help-button").setAttribute("aria-expanded", "false");
  help.append(close, make("h2", {}, "How to"), make("dl", {}, ...helpRows.flatMap(([key, what]) => [make("dt", {}, key), make("dd", {}, what)])),
    make("p", { class: "quiet" }, "Orange: the part in your hand. Blue ghost: where the device is. Red arrow: force on the hand. Pink arc: torque. White discs: contact points. Arrows at contacts are green where friction sticks, yellow where it slips."));
}
