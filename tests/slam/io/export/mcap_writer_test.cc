#include "slam/io/export/mcap_writer.h"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "slam/io/byte_number.h"
#include "slam/io/crc32.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Reads the fields of a record one after the other, as the specification lists them.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}

  template <typename Number>
  Number Take() {
    const std::optional<Number> number = ReadNumber<Number>(bytes_, 0, std::endian::little);
    if (!number) ADD_FAILURE() << "the record ends too early";
    bytes_.remove_prefix(std::min(bytes_.size(), sizeof(Number)));
    return number.value_or(0);
  }
  std::string Bytes(std::uint64_t size) {
    EXPECT_LE(size, bytes_.size());
    const std::string text(bytes_.substr(0, size));
    bytes_.remove_prefix(std::min<std::uint64_t>(size, bytes_.size()));
    return text;
  }
  std::string Text() { return Bytes(Take<std::uint32_t>()); }
  bool IsEmpty() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

struct Record {
  std::uint8_t opcode = 0;
  std::uint64_t start = 0, end = 0;  // in what was split
  std::string content;
};

std::vector<Record> Split(std::string_view bytes, std::uint64_t start, std::uint64_t end) {
  std::vector<Record> records;
  for (std::uint64_t at = start; at < end;) {
    Fields fields(bytes.substr(at));
    Record record{fields.Take<std::uint8_t>(), at, 0, {}};
    const auto size = fields.Take<std::uint64_t>();
    record.content = fields.Bytes(size);
    at += 1 + 8 + size;
    record.end = at;
    records.push_back(record);
  }
  EXPECT_TRUE(records.empty() || records.back().end == end);
  return records;
}

constexpr size_t kMagicBytes = 8;
constexpr std::uint64_t kFooterBytes = 1 + 8 + 20;

TEST(McapWriter, AFileWithoutMessagesHasTheBytesOfTheSpecification) {
  using std::string_literals::operator""s;
  const TempFolder folder;
  McapWriter(folder / "a.mcap", "p").Commit();
  const std::string magic = "\x89MCAP0\r\n"s;
  const std::string statistics =
      "\x0b\x2e\0\0\0\0\0\0\0"s + std::string(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8 + 4, '\0');
  const std::string offset = "\x0e\x11\0\0\0\0\0\0\0\x0b"s +  //
                             "\x2d\0\0\0\0\0\0\0"s +          // after 8 + 24 + 13 bytes
                             "\x37\0\0\0\0\0\0\0"s;
  std::string summary = statistics + offset + "\x02\x14\0\0\0\0\0\0\0"s + "\x2d\0\0\0\0\0\0\0"s +
                        "\x64\0\0\0\0\0\0\0"s;
  AppendLittleEndian(Crc32(summary), &summary);
  EXPECT_EQ(ReadText(folder / "a.mcap"), magic + "\x01\x0f\0\0\0\0\0\0\0\1\0\0\0p\6\0\0\0orb360"s +
                                             "\x0f\4\0\0\0\0\0\0\0\0\0\0\0"s + summary + magic);
}

TEST(McapWriter, MessagesAreFoundByTheIndexAtTheEnd) {
  const TempFolder folder;
  McapWriter writer(folder / "a.mcap", "ros2");
  const auto schema = writer.AddSchema("pkg/msg/Type", "ros2msg", "int32 a\n");
  const auto first = writer.AddChannel(schema, "/first", "cdr", {{"key", "value"}});
  const auto second = writer.AddChannel(schema, "/second", "cdr", {});
  // Messages of a megabyte fill several chunks; times need not ascend.
  std::map<std::string, std::vector<std::pair<std::uint64_t, std::string>>> written;
  for (int i = 0; i < 11; ++i) {
    const std::uint64_t time = 1'000'000'000'000U + static_cast<std::uint64_t>((i * 7) % 11);
    const std::string message(i % 2 == 0 ? 1'000'000 : 10, static_cast<char>('a' + i));
    writer.Write(i % 3 == 0 ? second : first, time, message);
    written[i % 3 == 0 ? "/second" : "/first"].emplace_back(time, message);
  }
  writer.Commit();

  const std::string file = ReadText(folder / "a.mcap");
  const std::uint64_t footer = file.size() - kMagicBytes - kFooterBytes;
  Fields end(std::string_view(file).substr(footer + 9));
  const auto summary_start = end.Take<std::uint64_t>();
  const auto offsets_start = end.Take<std::uint64_t>();
  EXPECT_EQ(end.Take<std::uint32_t>(),
            Crc32(std::string_view(file).substr(summary_start,
                                                file.size() - kMagicBytes - 4 - summary_start)));
  std::map<std::uint16_t, std::string> topics;
  std::map<std::string, std::vector<std::pair<std::uint64_t, std::string>>> read;
  size_t chunks = 0;
  for (const Record& record : Split(file, summary_start, offsets_start)) {
    Fields fields(record.content);
    if (record.opcode == 0x03) {
      EXPECT_EQ(fields.Take<std::uint16_t>(), schema);
      EXPECT_EQ(fields.Text(), "pkg/msg/Type");
      EXPECT_EQ(fields.Text(), "ros2msg");
      EXPECT_EQ(fields.Text(), "int32 a\n");
    } else if (record.opcode == 0x04) {
      const auto id = fields.Take<std::uint16_t>();
      EXPECT_EQ(fields.Take<std::uint16_t>(), schema);
      topics[id] = fields.Text();
      EXPECT_EQ(fields.Text(), "cdr");
      Fields metadata(record.content);
      const std::string entries = fields.Text();
      EXPECT_EQ(entries.empty(), topics[id] == "/second");
    } else if (record.opcode == 0x0B) {
      EXPECT_EQ(fields.Take<std::uint64_t>(), 11U) << "messages";
      EXPECT_EQ(fields.Take<std::uint16_t>(), 1U) << "schemas";
      EXPECT_EQ(fields.Take<std::uint32_t>(), 2U) << "channels";
      fields.Bytes(8);
      EXPECT_EQ(fields.Take<std::uint32_t>(), 2U) << "chunks of more than 4 MiB";
      EXPECT_EQ(fields.Take<std::uint64_t>(), 1'000'000'000'000U);
      EXPECT_EQ(fields.Take<std::uint64_t>(), 1'000'000'000'010U);
    } else {
      ASSERT_EQ(record.opcode, 0x08);
      ++chunks;
      const auto start_time = fields.Take<std::uint64_t>();
      const auto end_time = fields.Take<std::uint64_t>();
      const auto chunk_start = fields.Take<std::uint64_t>();
      const auto chunk_size = fields.Take<std::uint64_t>();
      const std::string offsets = fields.Text();
      const auto index_size = fields.Take<std::uint64_t>();
      EXPECT_EQ(fields.Text(), "") << "compression";
      const auto size = fields.Take<std::uint64_t>();
      EXPECT_EQ(fields.Take<std::uint64_t>(), size);
      const Record chunk = Split(file, chunk_start, chunk_start + chunk_size).at(0);
      ASSERT_EQ(chunk.opcode, 0x06);
      Fields head(chunk.content);
      EXPECT_EQ(head.Take<std::uint64_t>(), start_time);
      EXPECT_EQ(head.Take<std::uint64_t>(), end_time);
      EXPECT_EQ(head.Take<std::uint64_t>(), size);
      const auto crc = head.Take<std::uint32_t>();
      EXPECT_EQ(head.Text(), "");
      const std::string records = head.Bytes(head.Take<std::uint64_t>());
      EXPECT_TRUE(head.IsEmpty());
      EXPECT_EQ(crc, Crc32(records));
      std::uint64_t indexed_bytes = 0;
      for (Fields entries(offsets); !entries.IsEmpty();) {
        const auto channel = entries.Take<std::uint16_t>();
        const auto at = entries.Take<std::uint64_t>();
        const auto length = Fields(std::string_view(file).substr(at + 1)).Take<std::uint64_t>();
        indexed_bytes += 9 + length;
        const Record index = Split(file, at, at + 9 + length).at(0);
        ASSERT_EQ(index.opcode, 0x07);
        Fields found(index.content);
        EXPECT_EQ(found.Take<std::uint16_t>(), channel);
        const std::string places = found.Text();
        for (Fields messages(places); !messages.IsEmpty();) {
          const auto time = messages.Take<std::uint64_t>();
          Fields message(std::string_view(records).substr(messages.Take<std::uint64_t>()));
          EXPECT_EQ(message.Take<std::uint8_t>(), 0x05);
          const auto message_size = message.Take<std::uint64_t>();
          EXPECT_EQ(message.Take<std::uint16_t>(), channel);
          EXPECT_EQ(message.Take<std::uint32_t>(), read[topics[channel]].size()) << "sequence";
          EXPECT_EQ(message.Take<std::uint64_t>(), time);
          EXPECT_EQ(message.Take<std::uint64_t>(), time);
          EXPECT_GE(time, start_time);
          EXPECT_LE(time, end_time);
          read[topics[channel]].emplace_back(time, message.Bytes(message_size - 22));
        }
      }
      EXPECT_EQ(indexed_bytes, index_size);
    }
  }
  EXPECT_EQ(chunks, 2U);
  EXPECT_EQ(read, written);
  // Groups of the summary are found without reading it all.
  for (const Record& record : Split(file, offsets_start, footer)) {
    ASSERT_EQ(record.opcode, 0x0E);
    Fields fields(record.content);
    const auto opcode = fields.Take<std::uint8_t>();
    const auto start = fields.Take<std::uint64_t>();
    const auto length = fields.Take<std::uint64_t>();
    for (const Record& member : Split(file, start, start + length)) {
      EXPECT_EQ(member.opcode, opcode);
    }
  }
}

TEST(McapWriter, WhatWasNotDeclaredIsABrokenContract) {
  const TempFolder folder;
  McapWriter writer(folder / "a.mcap", "ros2");
  EXPECT_THROW(writer.Write(0, 1, "x"), ContractError);
  EXPECT_THROW(writer.AddChannel(1, "/a", "cdr", {}), ContractError);
}

}  // namespace
}  // namespace orb360
