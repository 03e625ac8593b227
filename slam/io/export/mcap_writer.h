#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slam/io/chunked_file.h"

namespace orb360 {

/// Writes an MCAP file (mcap.dev/spec, version 0): messages in chunks, which are indexed by channel
/// and time at the end of the file. Chunks are not compressed, because what is large in them are
/// encoded images. One chunk is in memory at a time. Throws UserError if the file cannot be
/// written.
class McapWriter {
 public:
  using Id = std::uint16_t;

  /// `profile` says what channels and messages mean, such as "ros2".
  McapWriter(const std::filesystem::path& path, std::string_view profile);

  /// Declares a type of messages by its definition, and returns its number.
  Id AddSchema(std::string_view name, std::string_view encoding, std::string_view definition);
  /// Declares a channel of messages of a declared type, and returns its number.
  Id AddChannel(Id schema, std::string_view topic, std::string_view message_encoding,
                const std::map<std::string, std::string>& metadata);
  /// Appends a message of a declared channel. `time`: nanoseconds.
  void Write(Id channel, std::uint64_t time, std::string_view message);
  /// Writes the index and makes the file appear under its name.
  void Commit();

 private:
  /// The first and last time of messages, nanoseconds; both 0 where there are none.
  struct TimeSpan {
    std::uint64_t start = 0, end = 0;
    std::uint64_t count = 0;  ///< Of the messages.
    void Extend(std::uint64_t time);
  };

  /// Writes what has been collected as a chunk, with its index.
  void FinishChunk();
  void WriteToFile(std::string_view bytes);
  std::string Statistics() const;

  ChunkedFile file_;
  std::uint64_t position_ = 0;                      // in the file
  std::string schemas_, channels_, chunk_indexes_;  // records of the summary
  std::uint16_t num_schemas_ = 0;
  std::uint32_t num_chunks_ = 0;
  TimeSpan span_;
  std::vector<std::uint64_t> counts_;  // messages, by channel

  std::string chunk_;  // the records of the present chunk
  TimeSpan chunk_span_;
  // Time and place in the chunk of each message, by channel.
  std::map<Id, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_messages_;
};

}  // namespace orb360
