// SPDX-License-Identifier: Apache-2.0
#include "cloth.glsl"
layout(local_size_x = kGroupLine) in;
