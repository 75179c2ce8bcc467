#!/usr/bin/env python3
"""Decodes every message of MCAP files with the public `mcap` and `mcap-protobuf-support` packages.

    python .ci/decode_all.py LOG.mcap...

Prints the messages per topic. Exits 1 on the first message that cannot be decoded, on a check sum
that is wrong, on log times that go back, on a count other than the file's own statistics, and on a
file without messages; 2 without arguments.
"""

import sys
from collections import Counter

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory


def check(path: str) -> None:
    counts: Counter[tuple[str, str]] = Counter()
    last = 0
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        if summary is None or summary.statistics is None:
            raise ValueError("no summary: the file has no proper end")
        # In file order: that log times increase is part of the contract.
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            if schema is None or channel.message_encoding != "protobuf":
                raise ValueError(f"{channel.topic} is not described as protobuf")
            if decoded.DESCRIPTOR.full_name != schema.name:
                raise ValueError(f"{channel.topic} decodes as {decoded.DESCRIPTOR.full_name}")
            # Reading every field is what decodes nested messages.
            decoded.ListFields()
            str(decoded)
            if message.log_time < last:
                raise ValueError(f"{channel.topic} goes back to {message.log_time} from {last}")
            last = message.log_time
            counts[channel.topic, schema.name] += 1
        runs = [record for record in reader.iter_metadata() if record.name == "tandem.run"]
        attachments = sorted(attachment.name for attachment in reader.iter_attachments())

    total = sum(counts.values())
    if total == 0:
        raise ValueError("no messages")
    if total != summary.statistics.message_count:
        raise ValueError(f"{total} messages, not {summary.statistics.message_count}")
    if len(runs) != 1:
        raise ValueError(f"{len(runs)} metadata records `tandem.run`, not 1")
    for name in ("params.toml", "scenario.toml", "layout.json"):
        if name not in attachments:
            raise ValueError(f"no attachment `{name}`")

    print(f"{path}: {total} messages")
    for (topic, schema), count in sorted(counts.items()):
        print(f"  {count:8} {topic} {schema}")


def main() -> int:
    paths = sys.argv[1:]
    if not paths:
        print(__doc__, file=sys.stderr)
        return 2
    for path in paths:
        try:
            check(path)
        except Exception as error:  # whatever a reader stumbles over counts against the file
            print(f"{path}: {type(error).__name__}: {error}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
