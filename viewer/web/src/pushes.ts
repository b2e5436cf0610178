// The contact points of a picture, gathered by patch: one push each, with its place and what it adds to the held part.
import type { Contact, Grip, Picture } from "./protocol";

export interface Push {
  patch: number;
  contact: Contact; // the first point: pieces and features
  force: number[]; // on the held part where it is one of the two, else on the first [N]
  at: number[]; // centre of pressure; of the points where nothing presses [m]
  distance: number; // least [m]
  points: number;
  onGrasped: boolean;
  grip: Grip; // of the surfaces, and the share of their friction cone in use
  coneUsed: number;
  rests: boolean; // no force is computed between bodies that sleep
}

export function pushesOf(picture: Picture, grasped: number): Push[] {
  const pushes = new Map<number, Push>();
  const weights = new Map<Push, number>();
  picture.contacts.forEach((contact, i) => {
    const key = contact.patch >= 0 ? contact.patch : -1 - i;
    const sign = contact.bodies[1] === grasped ? -1 : 1;
    let push = pushes.get(key);
    if (!push) {
      push = { patch: contact.patch, contact, force: [0, 0, 0], at: [0, 0, 0], distance: Infinity, points: 0, onGrasped: contact.bodies.includes(grasped),
        grip: "none", coneUsed: 0, rests: contact.rests };
      pushes.set(key, push);
    }
    if (contact.grip !== "none") [push.grip, push.coneUsed] = [contact.grip, contact.coneUsed];
    const weight = contact.force + 1e-9;
    for (let k = 0; k < 3; ++k) {
      push.force[k] += sign * contact.force * contact.n[k];
      push.at[k] += weight * contact.p[k];
    }
    weights.set(push, (weights.get(push) ?? 0) + weight);
    push.distance = Math.min(push.distance, contact.distance);
    ++push.points;
  });
  for (const [push, weight] of weights) push.at = push.at.map((v) => v / weight);
  return [...pushes.values()];
}
