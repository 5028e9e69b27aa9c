// SPDX-License-Identifier: GPL-3.0-or-later
// Has nothing of its own: the headers that every test includes are precompiled for it.
