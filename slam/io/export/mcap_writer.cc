#include "slam/io/export/mcap_writer.h"

#include <algorithm>
#include <limits>

#include "slam/io/byte_number.h"
#include "slam/io/crc32.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr size_t kChunkBytes = size_t{4} << 20;

/// Kinds of records.
enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

/// Text or bytes behind their number.
void AppendSized(std::string_view text, std::string* bytes) {
  ORB360_CHECK(text.size() <= std::numeric_limits<std::uint32_t>::max(), text.size());
  AppendLittleEndian(static_cast<std::uint32_t>(text.size()), bytes);
  *bytes += text;
}

/// The beginning of a record of so many bytes.
void AppendRecordStart(Opcode opcode, std::uint64_t size, std::string* bytes) {
  *bytes += static_cast<char>(opcode);
  AppendLittleEndian(size, bytes);
}

std::string Record(Opcode opcode, std::string_view content) {
  std::string record;
  AppendRecordStart(opcode, content.size(), &record);
  record += content;
  return record;
}

}  // namespace

void McapWriter::TimeSpan::Extend(std::uint64_t time) {
  start = count == 0 ? time : std::min(start, time);
  end = std::max(end, time);
  ++count;
}

McapWriter::McapWriter(const std::filesystem::path& path, std::string_view profile) : file_(path) {
  std::string header;
  AppendSized(profile, &header);
  AppendSized("orb360", &header);
  WriteToFile(kMagic);
  WriteToFile(Record(kHeader, header));
}

void McapWriter::WriteToFile(std::string_view bytes) {
  file_.Write(bytes);
  position_ += bytes.size();
}

McapWriter::Id McapWriter::AddSchema(std::string_view name, std::string_view encoding,
                                     std::string_view definition) {
  std::string schema;
  AppendLittleEndian(++num_schemas_, &schema);  // The number 0 is not allowed.
  AppendSized(name, &schema);
  AppendSized(encoding, &schema);
  AppendSized(definition, &schema);
  schemas_ += Record(kSchema, schema);
  chunk_ += Record(kSchema, schema);
  return num_schemas_;
}

McapWriter::Id McapWriter::AddChannel(Id schema, std::string_view topic,
                                      std::string_view message_encoding,
                                      const std::map<std::string, std::string>& metadata) {
  ORB360_CHECK(schema >= 1 && schema <= num_schemas_, schema);
  const auto id = static_cast<Id>(counts_.size());
  counts_.push_back(0);
  std::string channel, entries;
  AppendLittleEndian(id, &channel);
  AppendLittleEndian(schema, &channel);
  AppendSized(topic, &channel);
  AppendSized(message_encoding, &channel);
  for (const auto& [key, value] : metadata) {
    AppendSized(key, &entries);
    AppendSized(value, &entries);
  }
  AppendSized(entries, &channel);
  channels_ += Record(kChannel, channel);
  chunk_ += Record(kChannel, channel);
  return id;
}

void McapWriter::Write(Id channel, std::uint64_t time, std::string_view message) {
  ORB360_CHECK(channel < counts_.size(), channel);
  chunk_messages_[channel].emplace_back(time, chunk_.size());
  AppendRecordStart(kMessage, sizeof channel + 4 + 8 + 8 + message.size(), &chunk_);
  AppendLittleEndian(channel, &chunk_);
  AppendLittleEndian(static_cast<std::uint32_t>(counts_[channel]++), &chunk_);  // sequence number
  AppendLittleEndian(time, &chunk_);                                            // of recording
  AppendLittleEndian(time, &chunk_);                                            // of publication
  chunk_ += message;
  span_.Extend(time);
  chunk_span_.Extend(time);
  if (chunk_.size() >= kChunkBytes) FinishChunk();
}

void McapWriter::FinishChunk() {
  if (chunk_.empty()) return;
  const std::uint64_t chunk_start = position_;
  constexpr std::string_view kNoCompression;
  std::string head;
  AppendRecordStart(kChunk, 8 + 8 + 8 + 4 + 4 + kNoCompression.size() + 8 + chunk_.size(), &head);
  AppendLittleEndian(chunk_span_.start, &head);
  AppendLittleEndian(chunk_span_.end, &head);
  AppendLittleEndian<std::uint64_t>(chunk_.size(), &head);
  AppendLittleEndian(Crc32(chunk_), &head);
  AppendSized(kNoCompression, &head);
  AppendLittleEndian<std::uint64_t>(chunk_.size(), &head);
  WriteToFile(head);
  WriteToFile(chunk_);
  const std::uint64_t chunk_end = position_;

  std::string offsets;  // of the message indexes, by channel
  for (const auto& [channel, messages] : chunk_messages_) {
    AppendLittleEndian(channel, &offsets);
    AppendLittleEndian(position_, &offsets);
    std::string entries, index;
    for (const auto& [time, offset] : messages) {
      AppendLittleEndian(time, &entries);
      AppendLittleEndian(offset, &entries);
    }
    AppendLittleEndian(channel, &index);
    AppendSized(entries, &index);
    WriteToFile(Record(kMessageIndex, index));
  }

  std::string index;
  AppendLittleEndian(chunk_span_.start, &index);
  AppendLittleEndian(chunk_span_.end, &index);
  AppendLittleEndian(chunk_start, &index);
  AppendLittleEndian(chunk_end - chunk_start, &index);
  AppendSized(offsets, &index);
  AppendLittleEndian(position_ - chunk_end, &index);
  AppendSized(kNoCompression, &index);
  AppendLittleEndian<std::uint64_t>(chunk_.size(), &index);
  AppendLittleEndian<std::uint64_t>(chunk_.size(), &index);
  chunk_indexes_ += Record(kChunkIndex, index);

  ++num_chunks_;
  chunk_.clear();
  chunk_span_ = {};
  chunk_messages_.clear();
}

std::string McapWriter::Statistics() const {
  std::string statistics, counts;
  AppendLittleEndian(span_.count, &statistics);
  AppendLittleEndian(num_schemas_, &statistics);
  AppendLittleEndian(static_cast<std::uint32_t>(counts_.size()), &statistics);
  AppendLittleEndian<std::uint32_t>(0, &statistics);  // attachments
  AppendLittleEndian<std::uint32_t>(0, &statistics);  // metadata
  AppendLittleEndian(num_chunks_, &statistics);
  AppendLittleEndian(span_.start, &statistics);
  AppendLittleEndian(span_.end, &statistics);
  for (size_t channel = 0; channel < counts_.size(); ++channel) {
    AppendLittleEndian(static_cast<Id>(channel), &counts);
    AppendLittleEndian(counts_[channel], &counts);
  }
  AppendSized(counts, &statistics);
  return statistics;
}

void McapWriter::Commit() {
  FinishChunk();
  std::string data_end;
  AppendLittleEndian<std::uint32_t>(0, &data_end);  // No checksum: each chunk has one.
  WriteToFile(Record(kDataEnd, data_end));

  const std::uint64_t summary_start = position_;
  std::string summary, offsets;
  for (const auto& [opcode, records] : {std::pair(kSchema, schemas_),
                                        {kChannel, channels_},
                                        {kStatistics, Record(kStatistics, Statistics())},
                                        {kChunkIndex, chunk_indexes_}}) {
    if (records.empty()) continue;
    std::string offset;
    AppendLittleEndian(static_cast<std::uint8_t>(opcode), &offset);
    AppendLittleEndian<std::uint64_t>(summary_start + summary.size(), &offset);
    AppendLittleEndian<std::uint64_t>(records.size(), &offset);
    offsets += Record(kSummaryOffset, offset);
    summary += records;
  }
  const std::uint64_t offsets_start = summary_start + summary.size();
  summary += offsets;
  AppendRecordStart(kFooter, 8 + 8 + 4, &summary);
  AppendLittleEndian(summary_start, &summary);
  AppendLittleEndian(offsets_start, &summary);
  AppendLittleEndian(Crc32(summary), &summary);  // of all from the start of the summary to here
  WriteToFile(summary);
  WriteToFile(kMagic);
  file_.Commit();
}

}  // namespace orb360
