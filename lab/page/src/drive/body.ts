// Geometry of the swimmer from above: poses, and the outline of the body in the tank.

/** x, y of the middle link [m] and its heading [rad]. */
export type Pose = readonly [number, number, number];
export type Place = readonly [number, number];

export const MIDDLE: Pose = [0, 0, 0];

/** Pose of `inner`, which is given in the frame of `outer`. */
export function compose([x, y, theta]: Pose, [dx, dy, turn]: Pose): Pose {
  const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
  return [x + cos * dx - sin * dy, y + sin * dx + cos * dy, theta + turn];
}

/** Pose of the frame in which something at `inner` is at `outer`: `compose(frameOf(outer, inner), inner)` is `outer`. */
export function frameOf(outer: Pose, [x, y, theta]: Pose): Pose {
  const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
  return compose(outer, [-cos * x - sin * y, sin * x - cos * y, -theta]);
}

export interface Links {
  back_m: number;
  middle_m: number;
  front_m: number;
}

/** The body as a chain of four points: tip of the back link, back joint, front joint, tip of the front link. */
export function outline({ back_m, middle_m, front_m }: Links, pose: Pose, [front, back]: Place): Place[] {
  const half = middle_m / 2;
  const corners: Place[] = [
    [-half - back_m * Math.cos(back), back_m * Math.sin(back)],
    [-half, 0],
    [half, 0],
    [half + front_m * Math.cos(front), front_m * Math.sin(front)],
  ];
  return corners.map(([x, y]) => {
    const [px, py] = compose(pose, [x, y, 0]);
    return [px, py];
  });
}
