"""Attacks on a robot by somebody who has read docs/reference/protocol.md and nothing else.

    python3 attacks.py radio HOST:PORT        a stranger on the radio: no presence, no key
    python3 attacks.py bench HOST:PORT        somebody at the USB cable sets a key; a stranger follows

Each attack says what it expects; the exit status is 1 if any works.
"""

import struct
import sys
import time

import robot as r
import wire
from robot import Refused, Robot, varint

NEUTRAL = (1_500_000, 0.0274, 0, 0)
HOUR_US = 3_600_000_000
FRONT, BACK = 0, 1


def expect(what, seen, *wanted):
    if seen not in wanted:
        raise AssertionError(f"{what}: expected {' or '.join(map(str, wanted))}, got {seen}")


def armed(host, radius=1.0):
    """A host that holds a gait and has armed; returns what a play must name."""
    host.upload(r.circle(radius))
    host.ask(varint(r.ARM))
    return host.held()


# --- a stranger on the radio -----------------------------------------------------------------------------------------


def reversed_servo(host):
    """A mirrored joint passes the crossing check with a shape that crosses."""
    centre, slope, reversed_, trim = host.ask(r.servo(BACK))
    seen = host.refusal(r.set_servo(BACK, (centre, slope, 1 - reversed_, trim)))
    expect("reversing a servo without presence", seen, "NeedsPresence")
    expect("the map", host.ask(r.servo(BACK)), (centre, slope, reversed_, trim))


def shifted_servo(host):
    """Centre and trim together move a joint beyond what is checked."""
    before = host.ask(r.servo(FRONT))
    centre, slope, reversed_, _ = before
    for shift in ((centre + 20_000, slope, reversed_, 5000), (centre + 20_000, slope, reversed_, 0),
                  (centre, slope, reversed_, 5000), (centre, slope * 1.09, reversed_, 0)):
        expect(f"a map of {shift}", host.refusal(r.set_servo(FRONT, shift)), "NeedsPresence", "BadValue")
    expect("a trim of 0.5 rad", host.refusal(r.trim(FRONT, 5000)), "NeedsPresence")
    expect("the map", host.ask(r.servo(FRONT)), before)


def creeping_servo(host):
    """Small steps add up to what one may not do."""
    before = host.ask(r.servo(FRONT))
    centre, slope, reversed_, trim = before
    for step in range(1, 41):
        if host.refusal(r.trim(FRONT, trim + 60 * step)) is not None:
            break
    _, _, _, reached = host.ask(r.servo(FRONT))
    for step in range(1, 41):
        if host.refusal(r.set_servo(FRONT, (centre + 200 * step, slope, reversed_, reached))) is not None:
            break
    moved_centre, _, _, reached = host.ask(r.servo(FRONT))
    sum_rad = abs(moved_centre - centre) * 1e-3 * slope + abs(reached - trim) * 1e-4
    if sum_rad > 0.0175:
        raise AssertionError(f"crept by {sum_rad:.4f} rad without presence, over 1°")
    host.ask(r.set_servo(FRONT, before))


def widened_range(host):
    """End stops set at the bench are taken away again."""
    for joint in (FRONT, BACK):
        shortest, longest = host.ask(r.pulse_range(joint))
        host.ask(r.set_pulse_range(joint, shortest + 10_000, longest - 10_000))
        for wider in ((shortest, longest), (shortest, longest - 10_000), (shortest + 10_000, longest)):
            expect("a wider range", host.refusal(r.set_pulse_range(joint, *wider)), "NeedsPresence")
        expect("the range", host.ask(r.pulse_range(joint)), (shortest + 10_000, longest - 10_000))


def first_key(host):
    """The stranger's own key locks everybody else out."""
    expect("a first key", host.refusal(r.set_key(b"sixteen letters!")), "NeedsPresence")
    expect("the boot loader", host.refusal(varint(r.ENTER_BOOT_LOADER)), "NeedsPresence")


def silent_settings(host):
    """A host that has been silent for longer than its lease changes settings and clears latches."""
    centre, slope, reversed_, trim = host.ask(r.servo(FRONT))
    host.ask(varint(r.ESTOP))
    count = host.status().estops
    host.beats = False
    host.live(1.5)
    for what, body in (
            ("a servo", r.set_servo(FRONT, (centre + 100, slope, reversed_, trim))), ("a trim", r.trim(FRONT, trim + 10)),
            ("a range", r.set_pulse_range(FRONT, *host.ask(r.pulse_range(FRONT)))), ("a cleared e-stop", r.clear_estop(count)),
            ("arming", varint(r.ARM))):
        expect(f"{what} of a silent host", host.refusal(body), "NotFresh", "WrongState", "EStopped")
    expect("the e-stop", host.status().state, "EStopped")
    host.beats = True
    host.until(lambda told: not told.flags & r.LINK_SILENT, "the lease")
    host.ask(r.clear_estop(count))


def cleared_too_early(host):
    """A clear that was sent before a second e-stop clears the second; an arm clears as well."""
    host.ask(varint(r.ESTOP))
    first = host.status().estops
    host.ask(varint(r.ESTOP))
    expect("clearing the first of two e-stops", host.refusal(r.clear_estop(first)), "EStopCount")
    expect("arming an e-stopped robot", host.refusal(varint(r.ARM)), "EStopped")
    # Variant 10 once carried a flag that cleared the latch.
    expect("arming with a flag", host.refusal(varint(r.ARM) + b"\1"), "NotUnderstood")
    now = host.status()
    expect("the state", (now.state, now.estops), ("EStopped", first + 1))
    host.ask(r.clear_estop(first + 1))
    expect("the state", host.status().state, "Stopped")


def detached_for_ever(host):
    """A play that nobody watches goes on for 272 years."""
    held = armed(host)
    for cycles, period_us in ((2**32 - 1, 4_000_000), (901, 4_000_000), (0, 4_000_000), (1, HOUR_US + 1)):
        seen = host.refusal(r.play(cycles, period_us, 1, *held))
        expect(f"{cycles} cycles of {period_us} us, detached", seen, "DetachedTooLong", "BadValue")
    expect("the state", host.status().state, "Holding")
    # Two plays of 45 minutes follow each other.
    host.ask(r.play(675, 4_000_000, 1, *held))
    host.until(lambda told: told.state == "Playing", "the play")
    table = r.circle(1.0)
    upload = host.transfer(table)
    seen = host.refusal(r.follow(upload, 675, 4_000_000, wire.crc32c(table), held[1]))
    expect("a Follow that makes it an hour and a half", seen, "DetachedTooLong")
    host.stop()


def another_gait(host):
    """Somebody else's upload between the check and the play."""
    table, settings = armed(host)
    for what, wrong, name in (("another table", (table ^ 1, settings), "OtherTable"),
                              ("other settings", (table, settings ^ 1), "OtherSettings"),
                              ("no table", (0, settings), "OtherTable")):
        expect(f"a play of {what}", host.refusal(r.play(1, 4_000_000, 0, *wrong)), name)
    # The settings change after the check.
    host.stop()
    before = host.ask(r.servo(FRONT))
    host.ask(r.trim(FRONT, before[3] + 20))
    host.ask(varint(r.ARM))
    expect("a play of settings that changed", host.refusal(r.play(1, 4_000_000, 0, table, settings)), "OtherSettings")
    host.stop()
    host.ask(r.trim(FRONT, before[3]))
    expect("the settings' hash is of their bytes", host.held(), (table, settings))
    expect("and is what the page says", own_hash(host), settings)


def own_hash(host):
    """CRC-32C of configuration, servo maps and pulse ranges, as they stand on the wire."""
    configuration = host.ask(varint(r.CONFIGURATION))
    bytes_ = b"".join(wire.f32(value) for value in configuration.lengths)
    bytes_ += varint(configuration.drag[0]) + wire.f32(configuration.drag[1])
    bytes_ += b"".join(wire.f32(configuration[name]) for name in ("sphere", "max_angle", "max_rate"))
    for joint in (FRONT, BACK):
        bytes_ += r.servo_settings(*host.ask(r.servo(joint)))
    for joint in (FRONT, BACK):
        shortest, longest = host.ask(r.pulse_range(joint))
        bytes_ += varint(shortest) + varint(longest)
    return wire.crc32c(bytes_)


def never_played_table(host):
    """A stop while a Follow waits leaves a table that nobody has seen play."""
    for stop, after in ((r.STOP, "Stopped"), (r.ESTOP, "EStopped")):
        held = armed(host)
        host.ask(r.play(100, 4_000_000, 0, *held))
        host.until(lambda told: told.state == "Playing", "the play")
        never = r.circle(1.0, knots=96)
        upload = host.transfer(never)
        host.ask(r.follow(upload, 5, 4_000_000, wire.crc32c(never), held[1]))
        expect("the next table waits", host.status().flags & r.SWAP_PENDING, r.SWAP_PENDING)
        host.ask(varint(stop))
        host.until(lambda told: told.state == after, after)
        host.live(0.5)
        now = host.status()
        expect("the active table", now.table.crc32, held[0])
        if after == "EStopped":
            host.ask(r.clear_estop(now.estops))


def later_telemetry(host, robot_us):
    """Waits for telemetry that was sent so much of the robot's time after now."""
    host.until(lambda told: True, "later telemetry", since_us=host.status().robot_us + robot_us)


def worn_flash(host):
    """The stored table again and again, and settings that do not change: each a write of flash."""
    # The flag is set for the tick in which equal content is compared. Telemetry comes every 40 ms, and erasing a sector takes
    # longer, so that one real write in four shows in two telemetry in a row: twenty requests would show one with 99.7 %.
    # Between two requests lie 100 ms of the robot's time: two comparisons are not one write.
    table = r.circle(0.9)
    host.upload(table)
    host.until(lambda told: not told.flags & r.UNSAVED, "the table in flash", since_us=host.status().robot_us)
    later_telemetry(host, 100_000)
    host.history.clear()
    for _ in range(10):
        host.upload(table)
        later_telemetry(host, 100_000)
        settings = host.ask(r.servo(FRONT))
        host.ask(r.set_servo(FRONT, settings))
        later_telemetry(host, 100_000)
    flags = "".join("x" if told.flags & r.UNSAVED else " " for told in host.history)
    longest = max(len(run) for run in flags.split(" "))
    expect("a write of flash, by consecutive telemetry with something to be stored", longest > 1, False)


def other_sessions(host):
    """A wrong session number is answered with the right one, or acts."""
    for session in (0, host.session ^ 1, host.session ^ 0x8000):
        for body in (r.status(), varint(r.ARM), r.clear_estop(0), r.set_key(b"sixteen letters!")):
            try:
                host.ask(body, session=session, sequence=40_000)
                raise AssertionError(f"request {body[0]} of another session was done")
            except Refused as refused:
                expect("the refusal", refused.name, "StaleSession")
                if refused.rest:
                    raise AssertionError(f"StaleSession discloses {refused.rest.hex()}")
    expect("the state", host.status().state, "Stopped")


def old_versions(host):
    """Frames of development builds, and of no version, arm or play."""
    for version in (0, 1, 2, 3, 0x0F, 0x11, 0x20, 0xFF):
        number = host.number()
        host.send(wire.REQUEST, varint(r.ARM), sequence=number, version=version)
        host.live(0.1)
        expect(f"an arm of version {version}", host.status().state, "Stopped")


def stops_act(host):
    """A stop and an e-stop act whatever their session, number and version: nobody can take that away."""
    for version, session, sequence, stop in ((1, 0xBEEF, 300, r.STOP), (0xEE, 0, 0, r.STOP), (2, 77, 65535, r.ESTOP)):
        armed(host)
        host.until(lambda told: told.state == "Holding", "arming")
        host.send(wire.REQUEST, varint(stop), sequence=sequence, session=session, version=version)
        told = host.until(lambda told: told.state in ("Stopped", "EStopped"), "the stop", seconds=8)
        if stop == r.ESTOP:
            expect("the state", told.state, "EStopped")
            host.ask(r.clear_estop(host.status().estops))


def recorded_keep_alives(host):
    """Keep-alives out of a recording keep a robot moving whose host is dead."""
    held = armed(host)
    host.ask(r.play(0, 4_000_000, 0, *held))
    host.until(lambda told: told.state == "Playing", "the play")
    host.beats = False
    tape = [host.beat() for _ in range(3)]
    end = time.monotonic() + 15
    while host.told.state in ("Starting", "Playing"):
        if time.monotonic() > end:
            raise AssertionError("recorded keep-alives renew the lease")
        for frame in tape:
            host.socket.sendall(frame)
        host.live(0.05)
    expect("the cause", host.told.cause, "LinkLost")
    host.until(lambda told: told.state == "Stopped", "rest")
    host.beats = True
    host.until(lambda told: not told.flags & r.LINK_SILENT, "the lease")


RADIO = (reversed_servo, shifted_servo, creeping_servo, first_key, silent_settings, cleared_too_early, detached_for_ever,
         another_gait, never_played_table, worn_flash, other_sessions, old_versions, stops_act, recorded_keep_alives, widened_range)


# --- a key, set at the bench, and a stranger after that ----------------------------------------------------------------

KEY, OWN = b"sixteen letters!", b"a stranger's own"


def key_closes_the_session(host):
    """The session that set the key stays open and unsigned, and a stranger goes on in it."""
    old, number = host.session, host.number()
    host.ask(r.set_key(KEY), sequence=number)
    host.beats = False
    expect("the same request again gets its reply again", host.refusal(r.set_key(KEY), sequence=number), None)
    expect("the same number with another key", host.refusal(r.set_key(OWN), sequence=number), "StaleSession", "KeyNeeded")
    for body in (r.status(), varint(r.ARM), r.set_key(OWN), r.begin(r.circle(1.0))):
        for session in (old, old + 1 & 0xFFFF, 0):
            try:
                host.ask(body, session=session, sequence=number + 1)
                raise AssertionError(f"request {body[0]} was done after the key was set, unsigned")
            except Refused as refused:
                expect("the refusal", refused.name, "StaleSession", "KeyNeeded")
                if refused.rest:
                    raise AssertionError(f"{refused.name} discloses {refused.rest.hex()}")


def without_the_key(host):
    """A stranger greets, guesses and plays back."""
    host.greet(beats=False)
    for body in (r.status(), varint(r.ARM), r.set_key(OWN), r.clear_estop(0), r.begin(r.circle(1.0))):
        expect("an unsigned request", host.refusal(body), "KeyNeeded")
    host.greet(key=OWN, beats=False)
    for body in (r.status(), varint(r.ARM), r.set_key(OWN)):
        expect("a request signed with another key", host.refusal(body), "WrongKey")


def played_back(host):
    """What the owner signed acts once, in its session."""
    host.greet(key=KEY)
    number = host.number()
    arm = host.send(wire.REQUEST, varint(r.ARM), sequence=number)
    host.until(lambda told: told.state == "Holding", "arming")
    host.stop()
    for _ in range(3):
        host.socket.sendall(arm)
        host.live(0.2)
        expect("the state after an arm that was played back", host.told.state, "Stopped")
    host.greet(key=KEY)
    host.socket.sendall(arm)
    host.live(0.3)
    expect("the state after an arm of the session before", host.told.state, "Stopped")
    # Signed, but with a counter that was used.
    host.seal.counter -= 1
    host.send(wire.REQUEST, varint(r.ARM), sequence=host.number())
    host.live(0.3)
    expect("the state after an arm with a used counter", host.told.state, "Stopped")


def stops_need_no_key(host):
    """The key takes the stop away from nobody."""
    host.greet(key=KEY)
    host.ask(varint(r.ARM))
    host.until(lambda told: told.state == "Holding", "arming")
    host.send(wire.REQUEST, varint(r.STOP), sequence=9, session=0, seal=None, version=0)
    host.until(lambda told: told.state == "Stopped", "the stop")


def key_taken_away(host):
    """The owner changes the key and removes it; the old one is worth nothing at once."""
    host.ask(r.set_key(OWN))
    host.greet(key=KEY, beats=False)
    expect("a request signed with the old key", host.refusal(r.status()), "WrongKey")
    host.greet(key=OWN)
    host.ask(r.set_key(None))
    host.greet()
    expect("a key is set", host.status().flags & r.KEY_SET, 0)


BENCH = (key_closes_the_session, without_the_key, played_back, stops_need_no_key, key_taken_away)


def main():
    kind, address = sys.argv[1:]
    host = Robot(address)
    host.greet()  # the schema key is the robot's own from here on
    hello = host.greet()
    expect("presence", bool(host.told.flags & r.PRESENT), kind == "bench")
    print(f"{kind}: board {hello.board}, version {hello.current:#04x}, session {hello.session:#06x}")
    worked = 0
    for attack in {"radio": RADIO, "bench": BENCH}[kind]:
        began = time.monotonic()
        try:
            attack(host)
            verdict = "refused"
        except (AssertionError, Refused, r.Silence, ValueError, struct.error) as why:
            worked += 1
            verdict = f"WORKED OR FAILED: {type(why).__name__}: {why}"
        print(f"{attack.__name__:24} {verdict} ({time.monotonic() - began:.1f} s)", flush=True)
        if verdict != "refused" and kind == "radio":
            recover(host)
    host.close()
    print(f"{kind}: {worked} attacks that were not refused as they should be")
    return 1 if worked else 0


def recover(host):
    """Back to a robot at rest, for the attacks that follow."""
    try:
        host.greet()
        host.stop()
        now = host.status()
        if now.state == "EStopped":
            host.ask(r.clear_estop(now.estops))
    except (Refused, r.Silence) as why:
        print(f"  not at rest: {type(why).__name__}: {why}")


if __name__ == "__main__":
    sys.exit(main())
