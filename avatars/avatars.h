// Public header of the folder: body part meshes, body models (a URDF and its parts) and gaits.
#pragma once

#include "avatars/gait/gait.h"
#include "avatars/mesh/mesh.h"
#include "avatars/mesh/tri.h"
#include "avatars/model/model.h"
#include "base/errors.h"
