// Avatars: what a person is - body part meshes, a model made of a URDF and its parts, a gait.
#pragma once

#include "avatars/gait/gait.h"
#include "avatars/mesh/mesh.h"
#include "avatars/mesh/tri.h"
#include "avatars/model/model.h"
