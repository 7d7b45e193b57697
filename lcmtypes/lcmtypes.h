// Everything that speaks LCM: messages, publishing, recording, reading, guarding.
#pragma once

#include "lcmtypes/channels.h"
#include "lcmtypes/description.h"
#include "lcmtypes/drive_receiver.h"
#include "lcmtypes/encoder.h"
#include "lcmtypes/guard.h"
#include "lcmtypes/inbox.h"
#include "lcmtypes/lcm_sink.h"
#include "lcmtypes/log_check.h"
#include "lcmtypes/log_reader.h"
#include "lcmtypes/log_sink.h"
#include "lcmtypes/receiver.h"
#include "lcmtypes/run_reader.h"
#include "lcmtypes/tally.h"
