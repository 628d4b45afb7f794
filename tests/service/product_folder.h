// Checks of the folder into which a pipeline has written its products (pictures and movies).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pipeline/manifest.h"

namespace thunderhead::testing {

std::string Contents(const std::string& path);

// Returns the manifest's entries, by the file name of the product. Ignores an incomplete last line.
// Fails the test if a product has two entries.
std::map<std::string, pipeline::ManifestEntry> EntriesOf(const std::string& manifest);

// Fails the test unless every picture in the folder can be decoded. Call this only while no program
// writes into the folder.
void ExpectWholePictures(const std::string& folder);

// Fails the test unless the folder holds exactly the named products, their manifest with matching
// hashes, and `others`.
void ExpectFinished(const std::string& folder, const std::vector<std::string>& products,
                    const std::vector<std::string>& others = {});

}  // namespace thunderhead::testing
