// LCM: runs as messages - sent, logged, checked and read again - and avatars that messages drive.
#pragma once

#include "lcmtypes/codec/run_reader.h"
#include "lcmtypes/log/log_check.h"
#include "lcmtypes/log/log_reader.h"
#include "lcmtypes/log/log_sink.h"
#include "lcmtypes/wire/drive_receiver.h"
#include "lcmtypes/wire/lcm_sink.h"
#include "lcmtypes/wire/lockstep.h"
#include "lcmtypes/wire/receiver.h"
