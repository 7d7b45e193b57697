// Everything that speaks LCM: messages, publishing, recording, reading, guarding.
#pragma once

#include "lcmtypes/codec/channels.h"
#include "lcmtypes/codec/description.h"
#include "lcmtypes/codec/encoder.h"
#include "lcmtypes/codec/guard.h"
#include "lcmtypes/codec/run_reader.h"
#include "lcmtypes/log/log_check.h"
#include "lcmtypes/log/log_reader.h"
#include "lcmtypes/log/log_sink.h"
#include "lcmtypes/wire/drive_receiver.h"
#include "lcmtypes/wire/inbox.h"
#include "lcmtypes/wire/lcm_sink.h"
#include "lcmtypes/wire/receiver.h"
#include "lcmtypes/wire/tally.h"
