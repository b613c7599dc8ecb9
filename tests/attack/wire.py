"""The wire of a swimmer robot, written from docs/reference/protocol.md alone: COBS, CRC-32C, postcard, SipHash-2-4.

Nothing here is shared with the program under test. Only the standard library is used.
"""

import struct

# --- COBS -----------------------------------------------------------------------------------------------------------


def cobs_encode(raw):
    """Replaces each zero by the distance to the next one."""
    out, block = bytearray(), bytearray()
    for byte in raw:
        if byte:
            block.append(byte)
        if not byte or len(block) == 254:
            out += bytes([len(block) + 1]) + block
            block = bytearray()
    return bytes(out + bytes([len(block) + 1]) + block)


def cobs_decode(coded):
    """The inverse; None for bytes that no encoder makes."""
    out, at = bytearray(), 0
    while at < len(coded):
        code = coded[at]
        if code == 0 or at + code > len(coded):
            return None
        out += coded[at + 1:at + code]
        at += code
        if code < 255 and at < len(coded):
            out.append(0)
    return bytes(out)


# --- CRC-32C (Castagnoli, reflected, polynomial 0x1EDC6F41) -----------------------------------------------------------


def _crc_table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    return table


_CRC = _crc_table()


def crc32c(data):
    value = 0xFFFFFFFF
    for byte in data:
        value = value >> 8 ^ _CRC[(value ^ byte) & 255]
    return value ^ 0xFFFFFFFF


# --- SipHash-2-4 ----------------------------------------------------------------------------------------------------

_MASK = (1 << 64) - 1


def _rotate(value, by):
    return (value << by | value >> (64 - by)) & _MASK


def _rounds(v, count):
    v0, v1, v2, v3 = v
    for _ in range(count):
        v0 = (v0 + v1) & _MASK
        v1 = _rotate(v1, 13) ^ v0
        v0 = _rotate(v0, 32)
        v2 = (v2 + v3) & _MASK
        v3 = _rotate(v3, 16) ^ v2
        v0 = (v0 + v3) & _MASK
        v3 = _rotate(v3, 21) ^ v0
        v2 = (v2 + v1) & _MASK
        v1 = _rotate(v1, 17) ^ v2
        v2 = _rotate(v2, 32)
    return v0, v1, v2, v3


def siphash24(key, data):
    k0, k1 = struct.unpack("<QQ", key)
    v = (k0 ^ 0x736F6D6570736575, k1 ^ 0x646F72616E646F6D, k0 ^ 0x6C7967656E657261, k1 ^ 0x7465646279746573)
    padded = data + bytes(7 - len(data) % 8) + bytes([len(data) & 255])
    for (word,) in struct.iter_unpack("<Q", padded):
        v = _rounds((v[0], v[1], v[2], v[3] ^ word), 2)
        v = (v[0] ^ word, v[1], v[2], v[3])
    v = _rounds((v[0], v[1], v[2] ^ 0xFF, v[3]), 4)
    return v[0] ^ v[1] ^ v[2] ^ v[3]


# --- postcard -------------------------------------------------------------------------------------------------------


def varint(value):
    """Seven bits a byte, the lowest first; the top bit says that more follow."""
    out = bytearray()
    while True:
        value, low = value >> 7, value & 127
        out.append(low | (128 if value else 0))
        if not value:
            return bytes(out)


def zigzag(value):
    """Signed numbers: 0, -1, 1, -2, … as 0, 1, 2, 3, …"""
    return varint(2 * value if value >= 0 else -2 * value - 1)


def f32(value):
    return struct.pack("<f", value)


def byte_string(data):
    """A sequence of bytes: its length, then the bytes."""
    return varint(len(data)) + bytes(data)


class Reader:
    """Takes fields off the front of a body."""

    def __init__(self, body):
        self.body, self.at = body, 0

    def take(self, count):
        piece = self.body[self.at:self.at + count]
        if len(piece) < count:
            raise ValueError("the body is too short")
        self.at += count
        return piece

    def u8(self):
        return self.take(1)[0]

    def unsigned(self):
        value = shift = 0
        while True:
            byte = self.u8()
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    def signed(self):
        value = self.unsigned()
        return value >> 1 if value % 2 == 0 else -(value + 1 >> 1)

    def boolean(self):
        return self.u8() == 1

    def f32(self):
        return struct.unpack("<f", self.take(4))[0]

    def option(self, field):
        return field() if self.u8() else None

    def end(self):
        if self.at != len(self.body):
            raise ValueError(f"{len(self.body) - self.at} bytes are left over")


# --- frames ---------------------------------------------------------------------------------------------------------

VERSION = 0x10
HELLO, HELLO_REPLY, REQUEST, REPLY, TELEMETRY, HEARTBEAT, PONG = range(1, 8)
SIGNED = 0x80


class Frame:
    def __init__(self, version, session, sequence, kind, body, signature=b""):
        self.version, self.session, self.sequence = version, session, sequence
        self.kind, self.body, self.signature = kind, body, signature


class Seal:
    """A key bound to a session: signs frames, with a counter that only grows."""

    def __init__(self, key, boot_nonce, session, host_nonce):
        self.key = key
        self.bound = struct.pack("<IHI", boot_nonce, session, host_nonce)
        self.counter = 0

    def sign(self, header, body):
        self.counter += 1
        counter = self.counter.to_bytes(6, "little")
        tag = siphash24(self.key, self.bound + header + body + counter)
        return counter + tag.to_bytes(8, "little")


def encode(session, sequence, kind, body=b"", seal=None, version=VERSION):
    header = struct.pack("<BHHB", version, session, sequence, kind | (SIGNED if seal else 0))
    raw = header + body + (seal.sign(header, body) if seal else b"")
    raw += struct.pack("<I", crc32c(raw))
    if len(raw) > 128:
        raise ValueError("the frame is too long")
    return b"\0" + cobs_encode(raw) + b"\0"


def decode(coded):
    """The frame between two zeros; None if it is broken."""
    raw = cobs_decode(coded)
    if raw is None or len(raw) < 10 or crc32c(raw[:-4]) != struct.unpack("<I", raw[-4:])[0]:
        return None
    version, session, sequence, kind = struct.unpack("<BHHB", raw[:6])
    body, signature = raw[6:-4], b""
    if kind & SIGNED:
        if len(body) < 14:
            return None
        body, signature = body[:-14], body[-14:]
    return Frame(version, session, sequence, kind & ~SIGNED, body, signature)


def self_test():
    """Published vectors, so that two mistakes of this file do not cancel."""
    assert crc32c(b"123456789") == 0xE3069283
    assert siphash24(bytes(range(16)), bytes(range(15))) == 0xA129CA6149BE45E5
    assert cobs_encode(b"\x11\x22\x00\x33") == b"\x03\x11\x22\x02\x33"
    for length in (0, 1, 253, 254, 255, 300):
        for raw in (bytes(length), bytes(1 + i % 255 for i in range(length))):
            assert cobs_decode(cobs_encode(raw)) == raw
    assert varint(300) == b"\xac\x02" and zigzag(-1) == b"\x01" and zigzag(64) == b"\x80\x01"


self_test()
