#pragma once
#include <cstddef>
#include <string>

#include "device/device_info.h"

namespace mortise::run {

// Better no start than an end after hours: throws Error(Exit::device) where the device has not the memory that is needed [B]. A prediction that is
// nearly right is worth a word, which is returned. `remedy`: what needs less.
std::string compare_memory(std::size_t needed, const device::DeviceInfo& device, const std::string& remedy = "coarser meshes need less");

}  // namespace mortise::run
