#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace orb360 {

/// A mistake of the user (in a file, an option or an image). `what()` is one line to show, which
/// says what is wrong, where, and what to do.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A contract violated by code; thrown by ORB360_CHECK.
class ContractError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Used by macros of public headers only.
namespace internal {

/// Throws ContractError with file, line, expression and values; called by ORB360_CHECK.
template <typename... Values>
[[noreturn]] void FailContract(const char* file, int line, const char* expression,
                               const Values&... values) {
  std::ostringstream message;
  message << file << ':' << line << ": contract broken: " << expression;
  ((message << ' ' << values), ...);
  throw ContractError(message.str());
}

}  // namespace internal
}  // namespace orb360

/// Throws ContractError with the expression, and with the further arguments as values, unless the
/// expression holds.
#define ORB360_CHECK(expression, ...)                                  \
  ((expression) ? static_cast<void>(0)                                 \
                : ::orb360::internal::FailContract(__FILE__, __LINE__, \
                                                   #expression __VA_OPT__(, ) __VA_ARGS__))
