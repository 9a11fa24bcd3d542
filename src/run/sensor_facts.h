#pragma once
#include "output/field_file.h"
#include "sensors/sensors.h"

namespace mortise::run {

// What a reader of the field file has to know about the sensors' grids, as attributes of their groups. Call it in the first frame.
void write_sensor_facts(const Params& scene, const sensors::Sensors& sensors, output::FieldFile& file);

}  // namespace mortise::run
