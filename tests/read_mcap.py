"""Reads a flight with the MCAP project's own Python reader and prints what is in it as JSON.

The outside check of the log writer: nothing here is airball's code.

    pip install mcap==1.6.0 zstandard
    python3 tests/read_mcap.py flight.mcap

A file that was cut short is read up to the cut ("complete": false). Chunk checksums are verified. A whole file is
read a second time through its index, as viewers do ("indexed_messages").
"""

import json
import sys

from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Channel, Footer, Header, Message, Metadata, Schema, Statistics
from mcap.stream_reader import StreamReader


def summarise(path):
    """Walks the records in the order of the file."""
    schemas, channels, messages, metadata = {}, {}, {}, {}
    found = {"complete": False, "library": None, "statistics": None}
    with open(path, "rb") as file:
        records = StreamReader(file, validate_crcs=True).records
        while True:
            try:
                record = next(records, None)
            except (McapError, EOFError, ValueError) as error:
                found["error"] = f"{type(error).__name__}: {error}"
                break
            if record is None:
                break
            if isinstance(record, Header):
                found["library"] = record.library
            elif isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                messages.setdefault(record.channel_id, []).append(record)
            elif isinstance(record, Metadata):
                metadata[record.name] = record.metadata
            elif isinstance(record, Statistics):
                found["statistics"] = {"messages": record.message_count, "chunks": record.chunk_count}
            elif isinstance(record, Footer):
                found["complete"] = True
    return found, schemas, channels, messages, metadata


def main(path):
    """Prints the summary."""
    found, schemas, channels, messages, metadata = summarise(path)
    found["channels"] = {
        channel.topic: {
            "message_encoding": channel.message_encoding,
            "schema": schemas[channel.schema_id].name,
            "schema_encoding": schemas[channel.schema_id].encoding,
            "types": {name: field.get("type") for name, field in json.loads(schemas[channel.schema_id].data)["properties"].items()},
            "messages": len(messages.get(channel.id, [])),
        }
        for channel in channels.values()
    }
    found["metadata"] = metadata
    by_topic = {channels[id].topic: list_ for id, list_ in messages.items()}
    cycles = by_topic.get("cycle", [])
    for name, cycle in [("first_cycle", cycles[:1]), ("last_cycle", cycles[-1:])]:
        found[name] = {"log_time_ns": cycle[0].log_time, **json.loads(cycle[0].data)} if cycle else None
    found["events"] = [json.loads(event.data) for event in by_topic.get("event", [])]
    if found["complete"]:
        with open(path, "rb") as file:
            found["indexed_messages"] = sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages())
    json.dump(found, sys.stdout, indent=1, ensure_ascii=False)
    print()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
