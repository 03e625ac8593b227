#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

namespace orb360 {

/// A file of the data that lie beside checkouts and are not part of the repository.
inline std::filesystem::path SharedData(const std::string& name) {
  return std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/data" / name;
}

/// Standard output of a shell command.
inline std::string OutputOf(const std::string& command) {
  std::string output;
  FILE* pipe = popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer;
  for (size_t size = 0; (size = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    output.append(buffer.data(), size);
  }
  pclose(pipe);
  return output;
}

/// Whether a program of this name can be started.
inline bool HasProgram(const std::string& name) { return !OutputOf("command -v " + name).empty(); }

}  // namespace orb360
