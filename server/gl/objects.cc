#include "gl/objects.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "base/status.h"
#include "gl/device_faults.h"
#include "gl/device_memory.h"

namespace thunderhead::gl {
namespace internal {

void DeleteTexture(GLuint name) { glDeleteTextures(1, &name); }
void DeleteFramebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
void DeleteBuffer(GLuint name) { glDeleteBuffers(1, &name); }
void DeleteVertexArray(GLuint name) { glDeleteVertexArrays(1, &name); }

}  // namespace internal

namespace {

GLint WrapOf(Edge edge) {
  switch (edge) {
    case Edge::kClamp:
      return GL_CLAMP_TO_EDGE;
    case Edge::kZero:
      return GL_CLAMP_TO_BORDER;
    case Edge::kRepeat:
      return GL_REPEAT;
  }
  return GL_CLAMP_TO_EDGE;
}

GLuint NewTexture(GLenum target, Edge edge, Filter filter = Filter::kLinear) {
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  const GLint wrap = WrapOf(edge);
  const GLint sampling = filter == Filter::kLinear ? GL_LINEAR : GL_NEAREST;
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, sampling);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, sampling);
  glTextureParameteri(name, GL_TEXTURE_WRAP_S, wrap);
  glTextureParameteri(name, GL_TEXTURE_WRAP_T, wrap);
  glTextureParameteri(name, GL_TEXTURE_WRAP_R, wrap);
  return name;
}

}  // namespace

std::size_t BytesPerTexel(GLenum internal_format) {
  switch (internal_format) {
    case GL_R8UI:
    case GL_R8:
      return 1;
    case GL_RG8:
    case GL_R16F:
      return 2;
    case GL_RG16F:
    case GL_R32F:
    case GL_DEPTH_COMPONENT32F:
    case GL_RGBA8:
    case GL_SRGB8_ALPHA8:
      return 4;
    case GL_RGBA16:
    case GL_RGBA16F:
    case GL_RG32F:
      return 8;
    case GL_RGBA32F:
      return 16;
    default:
      THUNDERHEAD_CHECK(false, "unknown internal format " + std::to_string(internal_format));
  }
}

namespace {

std::size_t BytesOf(GLenum internal_format, const glm::ivec3& size) {
  return BytesPerTexel(internal_format) * static_cast<std::size_t>(size.x) *
         static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
}

}  // namespace

Texture2D::Texture2D(GLenum internal_format, glm::ivec2 size, Edge edge)
    : Texture2D(internal_format, size, edge, 1) {}

Texture2D Texture2D::WithMips(GLenum internal_format, glm::ivec2 size, Edge edge) {
  int levels = 1;
  while ((std::max(size.x, size.y) >> levels) > 0) ++levels;
  Texture2D texture(internal_format, size, edge, levels);
  glTextureParameteri(texture.Get(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  return texture;
}

Texture2D::Texture2D(GLenum internal_format, glm::ivec2 size, Edge edge, int levels)
    // Mip levels add a third to the bytes of the first level, apart from the rounding of odd sizes.
    : bytes_(BytesOf(internal_format, {size, 1}) * (levels > 1 ? 4 : 3) / 3),
      reserved_(DeviceMemory::Reserve(bytes_)),
      name_(NewTexture(GL_TEXTURE_2D, edge)),
      internal_format_(internal_format),
      size_(size),
      levels_(levels) {
  glTextureStorage2D(name_.Get(), levels, internal_format, size.x, size.y);
}

void Texture2D::Upload(GLenum format, GLenum type, const void* texels) {
  UploadRows(size_.y, format, type, texels);
  if (levels_ > 1) glGenerateTextureMipmap(name_.Get());
}

void Texture2D::UploadRows(int rows, GLenum format, GLenum type, const void* texels) {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(name_.Get(), 0, 0, 0, size_.x, rows, format, type, texels);
}

Texture3D::Texture3D(GLenum internal_format, glm::ivec3 size, Filter filter, Edge edge)
    : bytes_(BytesOf(internal_format, size)),
      reserved_(DeviceMemory::Reserve(bytes_)),
      name_(NewTexture(GL_TEXTURE_3D, edge, filter)),
      size_(size),
      internal_format_(internal_format) {
  glTextureStorage3D(name_.Get(), 1, internal_format, size.x, size.y, size.z);
}

void Texture3D::Upload(GLenum format, GLenum type, const void* texels) {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage3D(name_.Get(), 0, 0, 0, 0, size_.x, size_.y, size_.z, format, type, texels);
}

void Texture2D::Clear() { glClearTexImage(name_.Get(), 0, GL_RED, GL_FLOAT, nullptr); }

void Texture2D::BindImage(GLuint unit, GLenum access) const {
  glBindImageTexture(unit, name_.Get(), 0, GL_FALSE, 0, access, internal_format_);
}

void Texture3D::Download(GLenum format, GLenum type, std::size_t bytes, void* texels) const {
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(name_.Get(), 0, format, type, static_cast<GLsizei>(bytes), texels);
}

void Texture3D::Clear() { glClearTexImage(name_.Get(), 0, GL_RED, GL_FLOAT, nullptr); }

void Texture3D::BindImage(GLuint unit, GLenum access) const {
  glBindImageTexture(unit, name_.Get(), 0, GL_TRUE, 0, access, internal_format_);
}

Texture2DArray::Texture2DArray(GLenum internal_format, glm::ivec2 size, int layers)
    : bytes_(BytesOf(internal_format, {size, layers})),
      reserved_(DeviceMemory::Reserve(bytes_)),
      name_(NewTexture(GL_TEXTURE_2D_ARRAY, Edge::kClamp)),
      size_(size),
      layers_(layers),
      internal_format_(internal_format) {
  glTextureStorage3D(name_.Get(), 1, internal_format, size.x, size.y, layers);
}

void Texture2DArray::BindImage(GLuint unit, GLenum access) const {
  glBindImageTexture(unit, name_.Get(), 0, GL_TRUE, 0, access, internal_format_);
}

void Texture2DArray::Fill(const glm::ivec2& low, const glm::ivec2& high, float red,
                          float green) const {
  const std::array<float, 2> value = {red, green};
  glClearTexSubImage(name_.Get(), 0, low.x, low.y, 0, high.x - low.x, high.y - low.y, layers_,
                     GL_RG, GL_FLOAT, value.data());
}

std::vector<float> Texture2DArray::Download(int layer) const {
  std::vector<float> values(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                            4);
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glGetTextureSubImage(name_.Get(), 0, 0, 0, layer, size_.x, size_.y, 1, GL_RGBA, GL_FLOAT,
                       static_cast<GLsizei>(values.size() * sizeof(float)), values.data());
  return values;
}

Framebuffer::Framebuffer(const Texture2D& color) : Framebuffer({&color}) {}

Framebuffer::Framebuffer(std::initializer_list<const Texture2D*> colors, const Texture2D* depth) {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  name_ = Name<internal::DeleteFramebuffer>(name);
  std::vector<GLenum> drawn;
  for (const Texture2D* color : colors) {
    drawn.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(drawn.size()));
    glNamedFramebufferTexture(name, drawn.back(), color->Get(), 0);
    colors_.push_back({color->Get(), color->InternalFormat()});
    size_ = color->Size();
  }
  if (drawn.empty()) drawn.push_back(GL_NONE);
  glNamedFramebufferDrawBuffers(name, static_cast<GLsizei>(drawn.size()), drawn.data());
  if (depth != nullptr) {
    glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth->Get(), 0);
    depth_ = depth->Get();
    size_ = depth->Size();
  }
  const GLenum status = glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER);
  if (status == GL_FRAMEBUFFER_COMPLETE) return;
  // Two causes are not programming errors: a lost device, and too little memory for an attachment.
  if (absl::Status fault = FaultNow(); !fault.ok()) throw base::FailedAllocation(std::move(fault));
  THUNDERHEAD_CHECK(false, "framebuffer status " + std::to_string(status));
}

void Framebuffer::Bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, name_.Get());
  glViewport(0, 0, size_.x, size_.y);
}

void Framebuffer::Clear(float red, float green, float blue, float alpha, int attachment) const {
  const float color[4] = {red, green, blue, alpha};
  glClearNamedFramebufferfv(name_.Get(), GL_COLOR, attachment, color);
}

void Framebuffer::ClearDepth(float depth) const {
  glClearNamedFramebufferfv(name_.Get(), GL_DEPTH, 0, &depth);
}

void Framebuffer::BindImages(GLuint unit) const {
  for (const Color& color : colors_) {
    glBindImageTexture(unit++, color.name, 0, GL_FALSE, 0, GL_WRITE_ONLY, color.internal_format);
  }
}

Buffer::Buffer(std::size_t bytes, const void* data, GLbitfield flags)
    : bytes_(bytes), reserved_(DeviceMemory::Reserve(bytes)) {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  name_ = Name<internal::DeleteBuffer>(name);
  glNamedBufferStorage(name, static_cast<GLsizeiptr>(bytes), data, flags);
}

VertexArray VertexArray::Empty() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  VertexArray array;
  array.name_ = Name<internal::DeleteVertexArray>(name);
  return array;
}

VertexArray VertexArray::OfPositions(const Buffer& buffer) {
  VertexArray array = Empty();
  const GLuint name = array.name_.Get();
  glVertexArrayVertexBuffer(name, 0, buffer.Get(), 0, 3 * sizeof(float));
  glEnableVertexArrayAttrib(name, 0);
  glVertexArrayAttribFormat(name, 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(name, 0, 0);
  return array;
}

}  // namespace thunderhead::gl
