"""Reads an MCAP file of ROS 2 messages from its beginning, by mcap.dev/spec, and the messages by the
definitions in the file. What node's readers print has the same form."""

import base64
import re
import struct
import zlib
from pathlib import Path
from typing import Any

NUMBERS = {"bool": "?", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i",
           "uint32": "I", "float32": "f", "float64": "d", "int64": "q", "uint64": "Q"}


class Bytes:
    def __init__(self, data: bytes, at: int = 0) -> None:
        self.data, self.at = data, at

    def number(self, kind: str) -> Any:
        size = struct.calcsize(kind)
        self.at += size
        return struct.unpack_from("<" + kind, self.data, self.at - size)[0]

    def take(self, size: int) -> bytes:
        self.at += size
        assert self.at <= len(self.data)
        return self.data[self.at - size:self.at]

    def sized(self) -> bytes:
        return self.take(self.number("I"))


class Cdr:
    """Reads a message by a definition in the form "ros2msg"."""

    def __init__(self, name: str, definition: str) -> None:
        self.package = name.split("/")[0]
        self.types = {}
        for part in re.split("={80}\n", definition):
            name = re.match("MSG: (.*)\n", part)
            fields = re.findall(r"^([\w/]+)(\[\d*\])? (\w+)(?: [-\d.]+)?$", part, re.M)
            self.types[name.group(1) if name else ""] = fields

    def read(self, data: bytes) -> Any:
        assert data[:4] == b"\0\1\0\0"
        self.bytes = Bytes(data[4:])
        message = self.value("", self.package)
        assert self.bytes.at == len(self.bytes.data)
        return message

    def value(self, kind: str, package: str) -> Any:
        if kind in NUMBERS:
            size = struct.calcsize(NUMBERS[kind])
            self.bytes.at += -self.bytes.at % size
            return self.bytes.number(NUMBERS[kind])
        if kind == "string":
            text = self.bytes.take(self.value("uint32", ""))
            assert text[-1:] == b"\0"
            return text[:-1].decode()
        name = kind if kind in self.types else f"{package}/{kind}"
        package = name.split("/")[0] or package
        message = {}
        for field_kind, array, field in self.types[name]:
            if not array:
                message[field] = self.value(field_kind, package)
                continue
            count = int(array[1:-1]) if array != "[]" else self.value("uint32", "")
            if field_kind == "uint8":
                message[field] = base64.b64encode(self.bytes.take(count)).decode()
            else:
                message[field] = [self.value(field_kind, package) for _ in range(count)]
        return message


def read(path: Path) -> dict[str, Any]:
    data = path.read_bytes()
    magic = b"\x89MCAP0\r\n"
    assert data.startswith(magic) and data.endswith(magic)
    profile, schemas, channels, topics = "", {}, {}, {}

    def walk(data: bytes, at: int, end: int) -> None:
        nonlocal profile
        while at < end:
            record = Bytes(data, at)
            opcode, size = record.number("B"), record.number("Q")
            content = Bytes(record.take(size))
            at = record.at
            if opcode == 0x01:
                profile = content.sized().decode()
            elif opcode == 0x03:
                number = content.number("H")
                schemas[number] = [content.sized().decode() for _ in range(3)]
            elif opcode == 0x04:
                number, schema = content.number("H"), content.number("H")
                topic, encoding = content.sized().decode(), content.sized().decode()
                entries, metadata = Bytes(content.sized()), {}
                while entries.at < len(entries.data):
                    key = entries.sized().decode()
                    metadata[key] = entries.sized().decode()
                name, schema_encoding, definition = schemas[schema]
                channels[number] = topic, Cdr(name, definition)
                topics.setdefault(topic, {
                    "type": name, "encodings": [schema_encoding, encoding],
                    "quality": metadata["offered_qos_profiles"], "messages": []})
            elif opcode == 0x05:
                topic, cdr = channels[content.number("H")]
                assert content.number("I") == len(topics[topic]["messages"])
                time, published = content.number("Q"), content.number("Q")
                assert time == published
                message = cdr.read(content.data[content.at:])
                topics[topic]["messages"].append([str(time), message])
            elif opcode == 0x06:
                _, _, _, crc = (content.number(kind) for kind in "QQQI")
                assert content.sized() == b""
                records = content.take(content.number("Q"))
                assert zlib.crc32(records) == crc
                walk(records, 0, len(records))
            elif opcode == 0x0F:
                return  # What follows is the index, which node's reader follows.

    walk(data, len(magic), len(data))
    return {"profile": profile, "topics": topics}
