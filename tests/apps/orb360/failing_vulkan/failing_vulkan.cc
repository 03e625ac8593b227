// A library in the place of libvulkan.so.1 whose device is lost: it passes everything on to the
// true one, but only the first ORB360_TEST_SUBMISSIONS submissions to a queue, and with
// ORB360_TEST_NO_PIPELINES no layout of pipelines. ORB360_TEST_DEVICE_IS tells what is wrong with
// all devices: `old` (Vulkan 1.1), `inexact` (NaN is not kept), `small` (buffers of 16 KiB) or
// `hidden` (they cannot be listed); `gpu` only makes them graphics processors. Several are
// separated by spaces.

#include <cstdlib>
#include <string_view>

#include <dlfcn.h>
#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

namespace {

PFN_vkGetInstanceProcAddr true_instance_function = nullptr;
PFN_vkGetDeviceProcAddr true_device_function = nullptr;
PFN_vkQueueSubmit true_submit = nullptr;
PFN_vkGetPhysicalDeviceProperties2 true_properties = nullptr;
int submissions = 0;

bool DeviceIs(std::string_view what) {
  const char* const wrong = std::getenv("ORB360_TEST_DEVICE_IS");
  return wrong != nullptr && std::string_view(wrong).find(what) != std::string_view::npos;
}

VKAPI_ATTR void VKAPI_CALL GetProperties(VkPhysicalDevice device,
                                         VkPhysicalDeviceProperties2* properties) {
  true_properties(device, properties);
  if (DeviceIs("gpu")) properties->properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
  if (DeviceIs("small")) properties->properties.limits.maxStorageBufferRange = 1 << 14;
  if (DeviceIs("old")) properties->properties.apiVersion = VK_API_VERSION_1_1;
  if (!DeviceIs("inexact")) return;
  for (auto* next = static_cast<VkBaseOutStructure*>(properties->pNext); next != nullptr;
       next = next->pNext) {
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FLOAT_CONTROLS_PROPERTIES) {
      reinterpret_cast<VkPhysicalDeviceFloatControlsProperties*>(next)
          ->shaderSignedZeroInfNanPreserveFloat32 = VK_FALSE;
    }
  }
}

VKAPI_ATTR VkResult VKAPI_CALL FailToList(VkInstance, std::uint32_t*, VkPhysicalDevice*) {
  return VK_ERROR_INITIALIZATION_FAILED;
}

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
  if (std::string_view(name) == "vkEnumeratePhysicalDevices" && DeviceIs("hidden")) {
    return reinterpret_cast<PFN_vkVoidFunction>(FailToList);
  }
  if (std::string_view(name) == "vkGetPhysicalDeviceProperties2") {
    true_properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties2>(found);
    return reinterpret_cast<PFN_vkVoidFunction>(GetProperties);
  }
  if (std::string_view(name) != "vkGetDeviceProcAddr") return found;
  true_device_function = reinterpret_cast<PFN_vkGetDeviceProcAddr>(found);
  return reinterpret_cast<PFN_vkVoidFunction>(DeviceFunction);
}
