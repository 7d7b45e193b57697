#include "culling/culling.h"
