#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include <dlfcn.h>

namespace orb360::nn {

// ONNX Runtime's C interface is a table of functions whose order never changes; the npm package
// that has the library does not have the header. These are the positions of those used here.
enum OnnxRuntimeFunction : int {
  kGetErrorMessage = 2,
  kCreateEnv = 3,
  kCreateSession = 7,
  kCreateSessionFromArray = 8,
  kRun = 9,
  kCreateSessionOptions = 10,
  kEnableProfiling = 14,
  kSetIntraOpNumThreads = 24,
  kCreateTensorWithDataAsOrtValue = 49,
  kCreateCpuMemoryInfo = 69,
  kAllocatorFree = 76,
  kGetAllocatorWithDefaultOptions = 78,
  kReleaseStatus = 93,
  kReleaseMemoryInfo = 94,
  kReleaseSession = 95,
  kReleaseValue = 96,
  kReleaseSessionOptions = 100,
  kSessionEndProfiling = 110,
  kAddSessionConfigEntry = 130,
};

struct OnnxRuntimeApiBase {
  void* const* (*get_api)(std::uint32_t version);
  const char* (*get_version)();
};

/// The functions of a library of ONNX Runtime. A call that fails throws std::runtime_error.
class OnnxRuntimeApi {
 public:
  using Handle = void*;  // every object of the interface

  explicit OnnxRuntimeApi(const std::string& library) {
    void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) throw std::runtime_error(dlerror());
    const auto get_base =
        reinterpret_cast<const OnnxRuntimeApiBase* (*)()>(dlsym(handle, "OrtGetApiBase"));
    if (get_base == nullptr) throw std::runtime_error(library + " is not ONNX Runtime");
    constexpr std::uint32_t kVersionWithAllFunctions = 5;
    table_ = get_base()->get_api(kVersionWithAllFunctions);
    if (table_ == nullptr) throw std::runtime_error(library + " is too old");
  }

  template <typename... Arguments>
  void Call(OnnxRuntimeFunction function, Arguments... arguments) const {
    Handle status = reinterpret_cast<Handle (*)(Arguments...)>(table_[function])(arguments...);
    if (status == nullptr) return;
    const std::string message =
        reinterpret_cast<const char* (*)(Handle)>(table_[kGetErrorMessage])(status);
    Release(kReleaseStatus, status);
    throw std::runtime_error("ONNX Runtime: " + message);
  }
  void Release(OnnxRuntimeFunction function, Handle object) const {
    reinterpret_cast<void (*)(Handle)>(table_[function])(object);
  }

 private:
  void* const* table_;
};

}  // namespace orb360::nn
