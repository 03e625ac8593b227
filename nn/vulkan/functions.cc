#include "nn/vulkan/functions.h"

#include <string>

#include <dlfcn.h>

#include <orb360/nn/base/check.h>

namespace orb360::nn::vulkan {
namespace {

template <typename Function>
void Take(PFN_vkVoidFunction found, const char* name, Function* function) {
  if (found == nullptr) {
    throw UserError(std::string("the Vulkan driver has no function vk") + name +
                    "; update the driver, or use --device cpu");
  }
  *function = reinterpret_cast<Function>(found);
}

}  // namespace

LoaderFunctions LoadVulkan() {
  // It is never closed: drivers keep threads and memory that outlive their devices.
  void* const library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const reason = dlerror();  // It names the library.
    throw UserError(std::string("Vulkan cannot be used (") +
                    (reason != nullptr ? reason : "libvulkan.so.1 cannot be opened") +
                    "); install the driver of the graphics card and libvulkan1, or use "
                    "--device cpu");
  }
  LoaderFunctions loader;
  Take(reinterpret_cast<PFN_vkVoidFunction>(dlsym(library, "vkGetInstanceProcAddr")),
       "GetInstanceProcAddr", &loader.GetInstanceProcAddr);
#define ORB360_TAKE(name) \
  Take(loader.GetInstanceProcAddr(nullptr, "vk" #name), #name, &loader.name);
  ORB360_VULKAN_LOADER_FUNCTIONS(ORB360_TAKE)
#undef ORB360_TAKE
  return loader;
}

InstanceFunctions LoadInstance(const LoaderFunctions& loader, VkInstance instance) {
  InstanceFunctions functions;
#define ORB360_TAKE(name) \
  Take(loader.GetInstanceProcAddr(instance, "vk" #name), #name, &functions.name);
  ORB360_VULKAN_INSTANCE_FUNCTIONS(ORB360_TAKE)
#undef ORB360_TAKE
  return functions;
}

DeviceFunctions LoadDevice(const InstanceFunctions& functions, VkDevice device) {
  DeviceFunctions loaded;
#define ORB360_TAKE(name) \
  Take(functions.GetDeviceProcAddr(device, "vk" #name), #name, &loaded.name);
  ORB360_VULKAN_DEVICE_FUNCTIONS(ORB360_TAKE)
#undef ORB360_TAKE
  return loaded;
}

}  // namespace orb360::nn::vulkan
