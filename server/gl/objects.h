// Owned OpenGL objects: textures, framebuffers and buffers. Each is freed by its destructor, on the
// thread of the context that created it. Textures and buffers reserve memory (gl/device_memory.h)
// before they are created, and throw if there is not enough. The code uses direct state access
// (OpenGL 4.5) and does not use physics.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

#include "base/memory_budget.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::gl {

// Owns one GL name, which `Delete` frees.
template <void (*Delete)(GLuint)>
class Name {
 public:
  Name() = default;
  explicit Name(GLuint name) : name_(name) {}
  Name(Name&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Name& operator=(Name&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Name() {
    if (name_ != 0) Delete(name_);
  }
  GLuint Get() const { return name_; }

 private:
  GLuint name_ = 0;
};

namespace internal {
void DeleteTexture(GLuint name);
void DeleteFramebuffer(GLuint name);
void DeleteBuffer(GLuint name);
void DeleteVertexArray(GLuint name);
}  // namespace internal

enum class Edge { kClamp, kZero, kRepeat };  // the value of a texture fetch beyond the edge

// Returns the bytes of one texel of a sized internal format that this project uses.
std::size_t BytesPerTexel(GLenum internal_format);

// An immutable two-dimensional texture with linear filtering.
class Texture2D {
 public:
  Texture2D() = default;
  Texture2D(GLenum internal_format, glm::ivec2 size, Edge edge = Edge::kClamp);

  // Creates a texture with all levels down to one texel, for textureLod.
  static Texture2D WithMips(GLenum internal_format, glm::ivec2 size, Edge edge);

  // Fills the whole texture and generates its other levels. The parameters are those of
  // Texture3D::Upload.
  void Upload(GLenum format, GLenum type, const void* texels);
  // Fills the lowest `rows` rows of a texture that has only one level.
  void UploadRows(int rows, GLenum format, GLenum type, const void* texels);

  GLuint Get() const { return name_.Get(); }
  GLenum InternalFormat() const { return internal_format_; }
  glm::ivec2 Size() const { return size_; }
  std::size_t Bytes() const { return bytes_; }
  void Bind(GLuint unit) const { glBindTextureUnit(unit, name_.Get()); }
  // Fills the texture with zeros.
  void Clear();
  // Binds the texture for imageLoad and imageStore.
  void BindImage(GLuint unit, GLenum access) const;

 private:
  Texture2D(GLenum internal_format, glm::ivec2 size, Edge edge, int levels);

  std::size_t bytes_ = 0;
  base::MemoryReservation reserved_;
  Name<internal::DeleteTexture> name_;
  GLenum internal_format_ = 0;
  glm::ivec2 size_{0};
  int levels_ = 1;
};

enum class Filter { kLinear, kNearest };

// An immutable three-dimensional texture.
class Texture3D {
 public:
  Texture3D() = default;
  Texture3D(GLenum internal_format, glm::ivec3 size, Filter filter = Filter::kLinear,
            Edge edge = Edge::kClamp);

  // Fills the whole texture. `format` and `type` are those of glTextureSubImage3D, with tightly
  // packed rows.
  void Upload(GLenum format, GLenum type, const void* texels);

  GLuint Get() const { return name_.Get(); }
  GLenum InternalFormat() const { return internal_format_; }
  glm::ivec3 Size() const { return size_; }
  std::size_t Bytes() const { return bytes_; }
  void Bind(GLuint unit) const { glBindTextureUnit(unit, name_.Get()); }
  // Fills the texture with zeros.
  void Clear();
  // Reads the whole texture after pending drawing to it. `texels` must have room for `bytes` bytes,
  // with tightly packed rows.
  void Download(GLenum format, GLenum type, std::size_t bytes, void* texels) const;
  // Binds all layers for imageLoad and imageStore.
  void BindImage(GLuint unit, GLenum access) const;

 private:
  std::size_t bytes_ = 0;
  base::MemoryReservation reserved_;
  Name<internal::DeleteTexture> name_;
  glm::ivec3 size_{0};
  GLenum internal_format_ = 0;
};

// Immutable two-dimensional textures (layers) of one size, with linear filtering within each layer.
class Texture2DArray {
 public:
  Texture2DArray() = default;
  Texture2DArray(GLenum internal_format, glm::ivec2 size, int layers);

  glm::ivec2 Size() const { return size_; }
  int Layers() const { return layers_; }
  std::size_t Bytes() const { return bytes_; }
  void Bind(GLuint unit) const { glBindTextureUnit(unit, name_.Get()); }
  // Binds all layers for imageLoad and imageStore.
  void BindImage(GLuint unit, GLenum access) const;
  // Sets the texels from `low` to before `high` in all layers.
  void Fill(const glm::ivec2& low, const glm::ivec2& high, float red, float green) const;
  // Reads one layer as four floats for each texel, after pending drawing to it.
  std::vector<float> Download(int layer) const;

 private:
  std::size_t bytes_ = 0;
  base::MemoryReservation reserved_;
  Name<internal::DeleteTexture> name_;
  glm::ivec2 size_{0};
  int layers_ = 0;
  GLenum internal_format_ = 0;
};

// A framebuffer with colour attachments, a depth attachment (GL_DEPTH_COMPONENT32F), or both. It
// does not own the attachments.
class Framebuffer {
 public:
  Framebuffer() = default;
  explicit Framebuffer(const Texture2D& color);
  // Creates a framebuffer with the colour attachments in this order. All textures must have the
  // same size.
  explicit Framebuffer(std::initializer_list<const Texture2D*> colors,
                       const Texture2D* depth = nullptr);

  // Binds the framebuffer for drawing and sets the viewport to the whole texture.
  void Bind() const;
  void Clear(float red, float green, float blue, float alpha, int attachment = 0) const;
  void ClearDepth(float depth) const;
  // Binds the colour attachments for imageStore to consecutive image units from `unit` on.
  void BindImages(GLuint unit) const;
  GLuint Get() const { return name_.Get(); }
  glm::ivec2 Size() const { return size_; }
  GLuint Depth() const { return depth_; }  // name of the depth texture; 0 if there is none

 private:
  struct Color {
    GLuint name;
    GLenum internal_format;
  };

  Name<internal::DeleteFramebuffer> name_;
  std::vector<Color> colors_;
  GLuint depth_ = 0;
  glm::ivec2 size_{0};
};

// A buffer object of fixed size.
class Buffer {
 public:
  Buffer() = default;
  Buffer(std::size_t bytes, const void* data, GLbitfield flags);

  GLuint Get() const { return name_.Get(); }
  std::size_t Bytes() const { return bytes_; }
  // Binds the buffer as shader storage.
  void BindStorage(GLuint binding) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name_.Get());
  }

 private:
  std::size_t bytes_ = 0;
  base::MemoryReservation reserved_;
  Name<internal::DeleteBuffer> name_;
};

// A vertex array. Without attributes it serves shaders that compute their vertices from
// gl_VertexID.
class VertexArray {
 public:
  // Creates an array without attributes.
  static VertexArray Empty();
  // Creates an array whose attribute 0 is a vec3, read tightly packed from `buffer`.
  static VertexArray OfPositions(const Buffer& buffer);

  void Bind() const { glBindVertexArray(name_.Get()); }

 private:
  Name<internal::DeleteVertexArray> name_;
};

}  // namespace thunderhead::gl
