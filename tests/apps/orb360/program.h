#pragma once

#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/types.h>

#include "tests/slam/io/temp_folder.h"

namespace orb360 {

/// What a user sees of a program that has ended.
struct ProgramResult {
  int status = 0;  ///< Exit status; 128 + signal where a signal ended it, as in a shell.
  std::string out;
  std::string err;
  double peak_memory_mb = 0;  ///< Largest resident memory, MiB.
};

/// A program that was built, running with the given arguments.
class Program {
 public:
  /// `most_file_bytes`: no file may grow beyond, which looks to the program like a full disk; 0:
  /// no limit.
  explicit Program(const std::vector<std::string>& arguments, size_t most_file_bytes = 0,
                   const std::string& name = "orb360");
  /// Kills it if it still runs.
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void Signal(int signal) const;
  /// Waits until standard output contains `text`. False if the program ends without.
  bool WaitForOutput(const std::string& text);
  /// Standard output so far.
  std::string Output() const { return ReadText(folder_ / "out"); }
  ProgramResult Wait();

 private:
  bool HasEnded();

  TempFolder folder_;  // standard output and error
  pid_t pid_ = -1;
  int wait_status_ = 0;
  rusage usage_{};
  bool has_ended_ = false;
};

inline ProgramResult RunOrb360(const std::vector<std::string>& arguments) {
  return Program(arguments).Wait();
}
inline ProgramResult RunTown(const std::vector<std::string>& arguments) {
  return Program(arguments, 0, "town").Wait();
}

}  // namespace orb360
