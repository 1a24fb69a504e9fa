/** What the daemon's events look like here; docs/api.md says what each field means. */
export type Pose = { x_m: number; y_m: number; heading_rad: number };
export type Device = {
  name: string; link: string; armed: boolean; faults: string[]; detail: string; counters: [string, number][];
};
export type Status = {
  time_ns: number; mode: string; reason: string; devices: Device[]; battery_v: number | null; bumpers_rad: number[];
  mission_id: number | null; map_id: string | null; map_name: string | null; recording: string | null;
  held: string | null; map_unsaved: boolean; map_kept_version: number | null; since_ns: number | null;
  started_ns: number | null; commander?: { client: string; kind: string; since_ns: number; lease_s: number } | null;
};
export type Region = {
  belief: number; pose: Pose; covariance: number[][]; residual_m: number;
  extent: { x_min_m: number; x_max_m: number; y_min_m: number; y_max_m: number; heading_min_rad: number; heading_max_rad: number };
  circle: { x_m: number; y_m: number; radius_m: number };
  cover: { block_cells: number; runs: [number, number, number][] };
  cells: number; poses: number; best_rank: number; explained: boolean[];
};
export type Estimate = {
  time_ns: number; state: string; best: Pose | null; regions: Region[]; best_rank: number; readings: number;
  final: boolean; map_id: string; regions_left_out: number; bearings_rad: number[];
  in_odom?: Pose | null; map_from_odom?: Pose | null; ends?: { as_mapped: number; unseen: number; against_map: number } | null;
};
export type Odometry = { time_ns: number; in_odom: Pose; twist: { speed_mps: number; turn_radps: number } };
export type Mission = {
  time_ns: number; mission_id: number; kind: string; phase: string; stop: number; stops: number; message: string;
};
export type LogLine = { time_ns: number; level: string; logger: string; message: string };
export type Reading = { bearing_rad: number; range_m: number | null; status: string; origin_x_m: number; origin_y_m: number };
export type Sweep = { number: number; in_map: Pose | null; readings: Reading[]; total: number; is_done: boolean };
export type Plan = {
  mission_id: number; start_m: [number, number] | null; goal_m: [number, number] | null; waypoints_m: [number, number][];
  stops: { x_m: number; y_m: number; state: string; reason: string | null; nearest_m: [number, number] | null }[];
};
export type Choice = {
  map_id: string; stop: number; x_m: number; y_m: number; reason: string; tour_m: [number, number][];
  candidates: { x_m: number; y_m: number; score: number; area_m2: number }[];
};
export type ExploringEnded = {
  map_id: string; ending: string; stops: number; way_m: number; seen_m2: number;
  left: { x_m: number; y_m: number; width_m: number; why: string }[];
};
/** Something that became of a mission, or of the map that it makes. */
export type Happening = { time_ns: number; event: string; fields: any };
export type Driver = { browser: string; who: string };
export type Commander = { driver: Driver; mission_id: number; kind: string; attended: boolean; since_ns: number };
export type Hello = {
  gateway: string; console: string; robot: string; name: string; role: string; browser: string; time_ns: number;
  wall_offset_ns: number; patience_s: number; unattended: boolean; commands: string[];
};
export type Frame = { topic: string; event: string; session: string; seq: number; fields: any };
export type State = {
  hello: Hello | null; session: string | null; isOtherLife: boolean; status: Status | null; mission: Mission | null;
  pose: Estimate | null; odometry: Odometry | null; sweep: Sweep | null; progress: { taken: number; total: number } | null;
  plan: Plan | null; choice: Choice | null; exploringEnded: ExploringEnded | null; happenings: Happening[]; way: [number, number][]; log: LogLine[]; lost: Record<string, number>; rank: any;
  commander: Commander | null; wish: Driver | null; wishUntil: number;
  statusAt: number; odometryAt: number; questionAt: number; daemonSilent: number | null; isOpen: boolean;
  lines: { at: number; rates: Record<string, number>; battery: number | null }[];
};
