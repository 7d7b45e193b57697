#include "avatars/avatars.h"
