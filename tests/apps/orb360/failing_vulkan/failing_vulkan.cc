// A library in the place of libvulkan.so.1 whose device is lost: it passes everything on to the
// true one, but only the first ORB360_TEST_SUBMISSIONS submissions to a queue, and with
// ORB360_TEST_NO_PIPELINES no layout of pipelines.

#include <cstdlib>
#include <string_view>

#include <dlfcn.h>
#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

namespace {

PFN_vkGetInstanceProcAddr true_instance_function = nullptr;
PFN_vkGetDeviceProcAddr true_device_function = nullptr;
PFN_vkQueueSubmit true_submit = nullptr;
int submissions = 0;

VKAPI_ATTR VkResult VKAPI_CALL Submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* infos,
                                      VkFence fence) {
  const char* const limit = std::getenv("ORB360_TEST_SUBMISSIONS");
  if (limit != nullptr && submissions++ >= std::atoi(limit)) return VK_ERROR_DEVICE_LOST;
  return true_submit(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL HaveNoMemory(VkDevice, const VkPipelineLayoutCreateInfo*,
                                            const VkAllocationCallbacks*, VkPipelineLayout*) {
  return VK_ERROR_OUT_OF_HOST_MEMORY;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL DeviceFunction(VkDevice device, const char* name) {
  const PFN_vkVoidFunction found = true_device_function(device, name);
  if (std::string_view(name) == "vkCreatePipelineLayout" &&
      std::getenv("ORB360_TEST_NO_PIPELINES") != nullptr) {
    return reinterpret_cast<PFN_vkVoidFunction>(HaveNoMemory);
  }
  if (std::string_view(name) != "vkQueueSubmit") return found;
  true_submit = reinterpret_cast<PFN_vkQueueSubmit>(found);
  return reinterpret_cast<PFN_vkVoidFunction>(Submit);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL
vkGetInstanceProcAddr(VkInstance instance, const char* name) {
  if (true_instance_function == nullptr) {
    void* const library = dlopen(ORB360_TRUE_VULKAN, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return nullptr;
    true_instance_function =
        reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
  }
  const PFN_vkVoidFunction found = true_instance_function(instance, name);
  if (std::string_view(name) != "vkGetDeviceProcAddr") return found;
  true_device_function = reinterpret_cast<PFN_vkGetDeviceProcAddr>(found);
  return reinterpret_cast<PFN_vkVoidFunction>(DeviceFunction);
}
