#include "kinematics/kinematics.h"
