// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "geocloth/parametrize/convert.h"
#include "report/page_pictures.h"

namespace geocloth {

/// A conversion on one page of HTML by which a technical artist judges it at a glance: pictures, the measures against
/// their targets, warnings, repairs. It holds everything it shows and fetches nothing.
/// @param source  the file that was converted
[[nodiscard]] std::string conversion_page(const ConvertResult& result, const PagePictures& pictures,
                                          const std::string& source);

}  // namespace geocloth
