// lcm_io publishes, logs, checks and reads runs as LCM messages, and controls avatars by messages.
#pragma once

#include "base/errors.h"
#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "lcm_io/log/log_sink.h"
#include "lcm_io/wire/lcm_sink.h"
#include "lcm_io/wire/lockstep.h"
#include "lcm_io/wire/pose_command_receiver.h"
#include "lcm_io/wire/receiver.h"
