// Checks of the folder of products that a pipeline has left.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pipeline/manifest.h"

namespace thunderhead::testing {

std::string Contents(const std::string& path);

// Returns the entries of a manifest by the product's file, without a torn last line. Fails the test
// if a product has two entries.
std::map<std::string, pipeline::ManifestEntry> EntriesOf(const std::string& manifest);

// Fails the test unless every picture in the folder decodes. Call it only while nothing writes
// there.
void ExpectWholePictures(const std::string& folder);

// Fails the test unless the folder holds exactly the named products, their manifest with matching
// hashes, and `others`.
void ExpectFinished(const std::string& folder, const std::vector<std::string>& products,
                    const std::vector<std::string>& others = {});

}  // namespace thunderhead::testing
