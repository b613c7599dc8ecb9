"""A session with a swimmer robot over TCP: messages, sequence numbers and keep-alives, after docs/reference/protocol.md."""

import os
import select
import socket
import struct
import time

import wire
from wire import Reader, f32, varint, zigzag

# Requests, by their variant.
STATUS, COUNTERS, CONFIGURATION, CONFIGURE, SERVO, SET_SERVO, TRIM, BEGIN, CHUNK, COMMIT = range(10)
ARM, PLAY, PAUSE, RESUME, STOP, ESTOP, CLEAR_RESETS, CRASH_MESSAGE, TABLE, SET_KEY = range(10, 20)
BENCH, PULSE_RANGE, SET_PULSE_RANGE, CLEAR_ESTOP, ENTER_BOOT_LOADER, FOLLOW = range(20, 26)

STATES = ("Stopped", "EStopped", "Holding", "Starting", "Playing", "Paused", "Stopping", "Settling")
CAUSES = ("Boot", "Finished", "Requested", "PauseExpired", "LinkLost", "BatteryLow", "EStop")
REFUSALS = (
    "StaleSession", "Superseded", "Version", "NotUnderstood", "NotArmed", "EStopped", "WrongState", "BatteryLow", "ResetLoop",
    "NoTable", "NoSuchSlot", "BadLength", "NoUpload", "ChunkOutOfRange", "Incomplete", "CrcMismatch", "AngleLimit", "RateLimit",
    "NotClosed", "LinksCross", "DetachedTooLong", "SwapPending", "BadValue", "SlowToNeutral", "Busy", "KeyNeeded", "WrongKey",
    "NeedsPresence", "NotFresh", "NotJoined", "OtherTable", "OtherSettings", "EStopCount",
)
LINK_SILENT, SWAP_PENDING, UNSAVED, KEY_SET, PRESENT = 4, 16, 32, 256, 512


class Refused(Exception):
    """The robot's refusal. `rest` are the bytes of its fields."""

    def __init__(self, name, rest):
        super().__init__(name)
        self.name, self.rest = name, rest


class Silence(Exception):
    """Nothing came that was waited for."""


class Fields(dict):
    __getattr__ = dict.__getitem__


# --- bodies of requests -----------------------------------------------------------------------------------------------


def status():
    return varint(STATUS)


def servo(joint):
    return varint(SERVO) + varint(joint)


def servo_settings(centre_ns, slope, reversed_, trim):
    return varint(centre_ns) + f32(slope) + bytes([reversed_]) + zigzag(trim)


def set_servo(joint, settings):
    return varint(SET_SERVO) + varint(joint) + servo_settings(*settings)


def trim(joint, units):
    return varint(TRIM) + varint(joint) + zigzag(units)


def pulse_range(joint):
    return varint(PULSE_RANGE) + varint(joint)


def set_pulse_range(joint, shortest_ns, longest_ns):
    return varint(SET_PULSE_RANGE) + varint(joint) + varint(shortest_ns) + varint(longest_ns)


def begin(table):
    return varint(BEGIN) + bytes([0]) + varint(len(table)) + varint(wire.crc32c(table))


def chunk(upload, offset, data):
    return varint(CHUNK) + varint(upload) + varint(offset) + wire.byte_string(data)


def commit(upload):
    return varint(COMMIT) + varint(upload)


def play(cycles, period_us, detached, table_crc32, settings_crc32):
    body = varint(PLAY) + varint(cycles) + varint(period_us) + bytes([detached])
    return body + varint(table_crc32) + varint(settings_crc32)


def follow(upload, cycles, period_us, table_crc32, settings_crc32):
    body = varint(FOLLOW) + varint(upload) + varint(cycles) + varint(period_us)
    return body + varint(table_crc32) + varint(settings_crc32)


def pause(detached):
    return varint(PAUSE) + bytes([detached])


def clear_estop(count):
    return varint(CLEAR_ESTOP) + varint(count)


def set_key(key):
    return varint(SET_KEY) + (b"\1" + key if key else b"\0")


# --- replies ----------------------------------------------------------------------------------------------------------


def table_info(reader):
    return Fields(knots=reader.unsigned(), crc32=reader.unsigned(), stored=reader.boolean(), min_period_us=reader.unsigned())


def read_configuration(reader):
    lengths = [reader.f32() for _ in range(4)]
    drag = (reader.unsigned(), reader.f32())
    return Fields(lengths=lengths, drag=drag, sphere=reader.f32(), max_angle=reader.f32(), max_rate=reader.f32())


def read_status(reader):
    return Fields(
        robot_us=reader.unsigned(), state=STATES[reader.unsigned()], cause=CAUSES[reader.unsigned()], flags=reader.unsigned(),
        cycle=reader.unsigned(), cycles=reader.unsigned(), period_us=reader.unsigned(), phase=reader.unsigned(),
        setpoint=(reader.signed(), reader.signed()), battery_mv=reader.option(reader.unsigned),
        table=reader.option(lambda: table_info(reader)), upload=reader.option(reader.unsigned),
        settings_crc32=reader.unsigned(), estops=reader.unsigned())


def read_reply(body):
    """What was answered; None for Working."""
    reader = Reader(body)
    variant = reader.unsigned()
    if variant == 1:
        raise Refused(REFUSALS[reader.unsigned()], reader.take(len(body) - reader.at))
    reply = {
        0: lambda: True,
        2: lambda: None,
        3: lambda: read_status(reader),
        4: lambda: Fields(counters=reader.take(len(body) - reader.at)),
        5: lambda: read_configuration(reader),
        6: lambda: (reader.unsigned(), reader.f32(), reader.boolean(), reader.signed()),
        7: lambda: Fields(upload=reader.unsigned(), offset=reader.unsigned()),
        8: lambda: reader.take(reader.unsigned()),
        9: lambda: reader.option(lambda: table_info(reader)),
        10: lambda: Fields(window_s=reader.unsigned(), usb=reader.boolean(), short_starts=reader.u8(),
                           built=read_configuration(reader)),
        11: lambda: (reader.unsigned(), reader.unsigned()),
    }[variant]()
    reader.end()
    return reply


def read_telemetry(body):
    reader = Reader(body)
    told = Fields(
        robot_us=reader.unsigned(), state=STATES[reader.unsigned()], cause=CAUSES[reader.unsigned()], flags=reader.unsigned(),
        cycle=reader.unsigned(), cycles=reader.unsigned(), phase=reader.unsigned(),
        setpoint=(reader.signed(), reader.signed()), pulse_ns=(reader.unsigned(), reader.unsigned()),
        battery_mv=reader.option(reader.unsigned))
    reader.take(3 * 4)  # the pose
    reader.unsigned(), reader.unsigned()  # frames whole and broken
    reader.end()
    return told


def read_hello_reply(body):
    reader = Reader(body)
    told = Fields(host_nonce=reader.unsigned(), minimum=reader.u8(), current=reader.u8(), schema_key=reader.take(8))
    reader.take(3 + 8)  # firmware version and commit
    told.update(board=reader.unsigned(), reset_reason=reader.unsigned(), crash=reader.u8(), session=reader.unsigned(),
                boot_nonce=reader.unsigned(), max_angle=reader.f32(), max_rate=reader.f32(), pulse_min_ns=reader.unsigned(),
                pulse_max_ns=reader.unsigned(), max_knots=reader.unsigned(), window=reader.unsigned(), buffer=reader.unsigned())
    reader.end()
    return told


# --- the session ------------------------------------------------------------------------------------------------------

BEAT_S = 0.05
PATIENCE_S = 20.0
TRY_S = 1.0


class Robot:
    """A host of its own making: it keeps the rules of the page, and breaks them where an attack says so."""

    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=PATIENCE_S)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.received = b""
        self.session = self.sequence = 0
        self.seal = None
        self.beats = False
        self.next_beat = 0.0
        self.told = None  # telemetry, the latest
        self.heard_us = 0
        self.first_fresh = None  # host time of the first keep-alive that named a time of the robot
        self.fresh = False  # and its pong came
        self.history = []
        self.hello = None

    def close(self):
        self.socket.close()

    # Frames.

    def send(self, kind, body, sequence=None, session=None, seal="own", version=wire.VERSION):
        seal = self.seal if seal == "own" else seal
        session = self.session if session is None else session
        frame = wire.encode(session, self.sequence if sequence is None else sequence, kind, body, seal, version)
        self.socket.sendall(frame)
        return frame

    def frames(self, seconds):
        """Frames of the robot as they come, for so long; keep-alives go out meanwhile."""
        end = time.monotonic() + seconds
        while True:
            now = time.monotonic()
            if self.beats and now >= self.next_beat:
                self.next_beat = now + BEAT_S
                self.beat()
            left = min(end, self.next_beat if self.beats else end) - now
            if now >= end:
                return
            ready, _, _ = select.select([self.socket], [], [], max(left, 0))
            if not ready:
                continue
            data = self.socket.recv(4096)
            if not data:
                raise Silence("the robot closed the connection")
            *whole, self.received = (self.received + data).split(b"\0")
            for coded in whole:
                frame = wire.decode(coded) if coded else None
                if frame is not None:
                    self.take(frame)
                    yield frame

    def take(self, frame):
        if frame.kind == wire.TELEMETRY and frame.session == self.session:
            self.told = read_telemetry(frame.body)
            self.heard_us = max(self.heard_us, self.told.robot_us)
            self.history.append(self.told)
        elif frame.kind == wire.PONG and frame.session == self.session:
            reader = Reader(frame.body)
            host_us, _, sent_us = reader.unsigned(), reader.unsigned(), reader.unsigned()
            reader.end()
            self.heard_us = max(self.heard_us, sent_us)
            self.fresh |= self.first_fresh is not None and host_us >= self.first_fresh

    def beat(self, heard_us=None):
        heard_us = self.heard_us if heard_us is None else heard_us
        host_us = int(time.monotonic() * 1e6)
        if heard_us and self.first_fresh is None:
            self.first_fresh = host_us
        return self.send(wire.HEARTBEAT, varint(host_us) + varint(heard_us), sequence=0)

    def live(self, seconds):
        for _ in self.frames(seconds):
            pass

    def until(self, holds, what, seconds=PATIENCE_S, since_us=0):
        """Waits for telemetry that satisfies a condition and was sent at `since_us` of the robot's clock or later."""
        for frame in self.frames(seconds):
            if frame.kind == wire.TELEMETRY and frame.session == self.session:
                if self.told.robot_us >= since_us and holds(self.told):
                    return self.told
        raise Silence(f"waited for {what} in vain; the robot said last: {self.told}")

    # Session and requests.

    def greet(self, key=None, beats=True):
        nonce = int.from_bytes(os.urandom(4), "little")
        body = bytes([wire.VERSION, wire.VERSION]) + self.schema_key() + varint(nonce)
        self.beats, self.seal, self.heard_us = False, None, 0
        self.first_fresh, self.fresh = None, False
        for _ in range(20):
            self.send(wire.HELLO, body, sequence=7, session=0)
            for frame in self.frames(TRY_S):
                if frame.kind == wire.HELLO_REPLY and read_hello_reply(frame.body).host_nonce == nonce:
                    self.hello = read_hello_reply(frame.body)
                    self.session, self.sequence = self.hello.session, 0
                    if key:
                        self.seal = wire.Seal(key, self.hello.boot_nonce, self.session, nonce)
                    self.beats = beats
                    if beats:
                        self.until(lambda told: self.fresh and not told.flags & LINK_SILENT, "the lease")
                    return self.hello
        raise Silence("no reply to the greeting")

    def schema_key(self):
        return self.hello.schema_key if self.hello else bytes(8)

    def ask(self, body, sequence=None, **how):
        """A request and its answer, sent again under its number until it comes."""
        if sequence is None:
            self.sequence = self.sequence % 65535 + 1
            sequence = self.sequence
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            self.send(wire.REQUEST, body, sequence=sequence, **how)
            for frame in self.frames(TRY_S):
                if frame.kind == wire.REPLY and frame.sequence == sequence:
                    reply = read_reply(frame.body)
                    if reply is not None:
                        return reply
        raise Silence(f"no reply to request {body[0]}")

    def refusal(self, body, **how):
        """The name of the refusal of a request; None if it was done."""
        try:
            self.ask(body, **how)
            return None
        except Refused as refused:
            return refused.name

    def status(self):
        return self.ask(status())

    def number(self):
        self.sequence = self.sequence % 65535 + 1
        return self.sequence

    def transfer(self, table):
        """Begin and every chunk; returns the upload's number."""
        upload = self.number()
        wanted = self.ask(begin(table), sequence=upload).offset
        while wanted < len(table):
            wanted = self.ask(chunk(upload, wanted, table[wanted:wanted + 88])).offset
        return upload

    def upload(self, table):
        upload = self.transfer(table)
        return self.ask(commit(upload))

    def held(self):
        """Checksums of the table and of the settings that the robot holds."""
        now = self.status()
        return (now.table.crc32 if now.table else 0), now.settings_crc32

    def stop(self):
        """Stops and waits for rest."""
        self.ask(varint(STOP))
        self.until(lambda told: told.state in ("Stopped", "EStopped"), "rest", since_us=self.status().robot_us)


def circle(radius, knots=64, phase=0.0):
    """A table: knots of two angles in 1e-4 rad, little-endian."""
    from math import cos, sin, tau
    angles = [(tau * i / knots + phase) for i in range(knots)]
    return b"".join(struct.pack("<hh", round(1e4 * radius * cos(a)), round(1e4 * radius * sin(a))) for a in angles)
