#include "tests/apps/orb360/program.h"

#include <chrono>
#include <csignal>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace orb360 {

Program::Program(const std::vector<std::string>& arguments, size_t most_file_bytes,
                 const std::string& name) {
  std::string path = std::string(ORB360_BINARY_DIR) + "/" + name;
  std::vector<std::string> words = arguments;
  std::vector<char*> argv = {path.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string out = folder_ / "out";
  const std::string err = folder_ / "err";
  pid_ = fork();
  if (pid_ != 0) return;

  // The child: only async-signal-safe calls from here on.
  dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
  if (most_file_bytes > 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{most_file_bytes, most_file_bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  execv(path.c_str(), argv.data());
  _exit(127);
}

Program::~Program() {
  if (HasEnded()) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void Program::Signal(int signal) const { kill(pid_, signal); }

bool Program::HasEnded() {
  if (!has_ended_) has_ended_ = wait4(pid_, &wait_status_, WNOHANG, &usage_) == pid_;
  return has_ended_;
}

bool Program::WaitForOutput(const std::string& text) {
  const auto is_there = [&] { return ReadText(folder_ / "out").find(text) != std::string::npos; };
  while (!is_there()) {
    if (HasEnded()) return is_there();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

ProgramResult Program::Wait() {
  if (!has_ended_) wait4(pid_, &wait_status_, 0, &usage_);
  has_ended_ = true;
  return {WIFEXITED(wait_status_) ? WEXITSTATUS(wait_status_) : 128 + WTERMSIG(wait_status_),
          ReadText(folder_ / "out"), ReadText(folder_ / "err"),
          static_cast<double>(usage_.ru_maxrss) / 1024.0};
}

}  // namespace orb360
