// Sliders of the swimmer, its bounds and its environment.

import { edit, endGesture, type Document, type Row, ROWS, shown, type With } from "./document.ts";
import { swimmer } from "./model.ts";
import { angle, rate, ROW_NAMES } from "./names.ts";

const PRESETS = ["purcell", "robot", "robot-slender"];

interface SliderProps {
  id: string;
  name: string;
  about: string;
  value: number;
  from: number;
  to: number;
  step: number;
  unit: string;
  tell?: string;
  set(value: number): void;
}

function Slider({ id, name, about, value, from, to, step, unit, tell, set }: SliderProps) {
  return (
    <label class="slider" title={about}>
      <span>{name}</span>
      <input
        id={id}
        type="range"
        min={from}
        max={to}
        step={step}
        value={value}
        aria-valuetext={tell ?? `${value} ${unit}`}
        onInput={(event) => set(event.currentTarget.valueAsNumber)}
        onChange={endGesture}
      />
      <output>{tell ?? `${Number(value.toPrecision(4))} ${unit}`}</output>
    </label>
  );
}

const change = (key: keyof With) => (value: number) => edit({ with: { ...shown.value.with, [key]: value } }, `slide-${key}`);
const set = <K extends keyof Document>(key: K, value: Document[K]) => edit({ [key]: value }, `slide-${key}`);

export function Sliders() {
  const about = swimmer.value;
  const { maxAngle, noOverlap, halfWidth, period, tank, row, objective } = shown.value;
  if (!about) return <section class="card">Reading the swimmer…</section>;
  const longest = 0.6 * about.total_length_m;
  const changed = Object.keys(shown.value.with).length > 0;
  return (
    <section class="card" aria-label="Swimmer and bounds">
      <div class="bar-of-buttons">
        <h2>Swimmer</h2>
        <select aria-label="Swimmer" value={PRESETS.includes(shown.value.swimmer) ? shown.value.swimmer : ""} onChange={(event) => edit({ swimmer: event.currentTarget.value, with: {} })}>
          {PRESETS.map((name) => <option key={name}>{name}</option>)}
          {!PRESETS.includes(shown.value.swimmer) && <option value="">{about.name}</option>}
        </select>
        <button disabled={!changed} onClick={() => edit({ with: {} })} title="The swimmer as its file has it">Reset</button>
      </div>
      <Slider id="chi" name="drag ratio χ" about="Drag ratio c_n/c_t" value={about.chi} from={1.05} to={5} step={0.01} unit="" set={change("chi")} />
      <Slider id="sphere" name="sphere rₛ" about="Radius of the sphere" value={about.sphere_radius_m * 1000} from={0} to={longest * 600} step={longest} unit="mm" set={(value) => change("sphere_radius_m")(value / 1000)} />
      <Slider id="middle" name="middle link l₀" about="Middle link" value={about.middle_m * 1000} from={longest * 50} to={longest * 1400} step={longest * 2} unit="mm" set={(value) => change("middle_m")(value / 1000)} />
      <Slider id="side" name="side links l₁, l₂" about="Side links" value={about.front_m * 1000} from={longest * 50} to={longest * 1400} step={longest * 2} unit="mm"
        set={(value) => edit({ with: { ...shown.value.with, front_m: value / 1000, back_m: value / 1000 } }, "slide-side")} />
      <Slider id="rate" name="servo rate" about="Fastest turn of the servos" value={about.max_rate_rad_s} from={0.2} to={8} step={0.1} unit="rad/s" tell={rate(about.max_rate_rad_s)} set={change("max_rate_rad_s")} />
      <h2>Bounds and map</h2>
      <Slider id="max-angle" name="|φ| ≤" about="Bound on the joints, for optimiser and certificate; none at the right end" value={maxAngle ?? 3.15} from={0.5} to={3.15} step={0.05} unit="rad"
        tell={maxAngle === null ? "none" : angle(maxAngle)} set={(value) => set("maxAngle", value > 3.14 ? null : value)} />
      <label class="check"><input type="checkbox" checked={noOverlap} onChange={() => edit({ noOverlap: !noOverlap })} /> links may not cross</label>
      <Slider id="half-width" name="map to" about="Joint angles that the map shows; its frame is the best over just these" value={halfWidth} from={1} to={3.6} step={0.1} unit="rad" tell={angle(halfWidth)} set={(value) => set("halfWidth", value)} />
      <Slider id="period" name="period" about="Seconds of a cycle" value={period} from={1} to={60} step={0.5} unit="s" set={(value) => set("period", value)} />
      <Slider id="tank" name="tank" about="Length of the tank; its width is half of it" value={tank[0]} from={0.5} to={20} step={0.1} unit="m" set={(value) => set("tank", [value, value / 2])} />
      <div class="bar-of-buttons">
        <label>row{" "}
          <select id="row" value={row} onChange={(event) => edit({ row: event.currentTarget.value as Row })}>
            {ROWS.map((each) => <option key={each} value={each}>{ROW_NAMES[each]}</option>)}
          </select>
        </label>
        <label>certify for{" "}
          <select id="objective" value={objective} onChange={(event) => edit({ objective: event.currentTarget.value as Document["objective"] })}>
            <option>displacement</option>
            <option>efficiency</option>
          </select>
        </label>
      </div>
    </section>
  );
}
