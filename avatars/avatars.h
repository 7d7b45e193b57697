// Avatars: what a person is - body part meshes, a model made of a URDF and its parts, a gait.
#pragma once

#include "avatars/gait.h"
#include "avatars/mesh.h"
#include "avatars/model.h"
#include "avatars/tri.h"
