// Checks of the folder of products that a pipeline has left.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pipeline/manifest.h"

namespace thunderhead::testing {

std::string Contents(const std::string& path);

// The entries of a manifest by the product's file; a torn last line is left out. Fails the test if
// a product has two.
std::map<std::string, pipeline::ManifestEntry> EntriesOf(const std::string& manifest);

// Fails the test unless every picture in the folder decodes. Called while nothing writes there.
void ExpectWholePictures(const std::string& folder);

// Fails the test unless the folder holds the products named, their manifest, whose hashes are
// theirs, and nothing else but `others`.
void ExpectFinished(const std::string& folder, const std::vector<std::string>& products,
                    const std::vector<std::string>& others = {});

}  // namespace thunderhead::testing
