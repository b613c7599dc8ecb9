// Steps from a new board to a robot that can be connected, with the commands to copy.

interface Step {
  title: string;
  text: string;
  command?: string;
}

const STEPS: readonly Step[] = [
  {
    title: "Flash the board",
    text: "Hold BOOTSEL of a Pico while you plug it in; on a Nano join REC to GND. The command writes the firmware; without the command, copy the UF2 of the board onto the drive RPI-RP2. Later updates need only the cable and no button.",
    command: "swimmer robot flash swimmer-pico.uf2 --by-hand",
  },
  { title: "Try the cable", text: "This prints board, firmware and limits. The LED flashes briefly every two seconds.", command: "swimmer robot info" },
  {
    title: "Set up the servos",
    text: "Remove the horns first: a servo jumps to neutral when its pulses begin. The command asks which servo turned and which angles the joints show, finds sign, centre, slope, dead band and end stops, stores them on the robot, and writes a swimmer file. Drop that file on Explore.",
    command: "swimmer robot setup --swimmer our-robot.toml -o our-robot-servos.toml",
  },
  { title: "Connect", text: "Close the other programs that use the port, and choose “Serial port” above; or let the command serve the robot to this page.", command: "swimmer lab --port PORT" },
];

/** Flashing and servo set-up of a new robot. */
export function SetUp() {
  return (
    <details class="set-up" id="set-up">
      <summary>A new robot: flash it and set up its servos</summary>
      <ol>
        {STEPS.map(({ title, text, command }) => (
          <li key={title}>
            <strong>{title}.</strong> {text}
            {command && <code tabIndex={0}>{command}</code>}
          </li>
        ))}
      </ol>
      <p class="soft">Wiring, Bluetooth and the first play are on the page “First day” of the book (docs/first-day.md).</p>
    </details>
  );
}
