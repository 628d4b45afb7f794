#include "gl/context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <charconv>
#include <cstdlib>
#include <initializer_list>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "base/status.h"
#include "gl/device.h"
#include "spdlog/spdlog.h"

namespace thunderhead::gl {
namespace {

constexpr int kMaxDevices = 64;

std::string GlString(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

// A reference to a display. EGL returns the same display to all contexts of a device, and
// eglTerminate ends it for all of them. This class therefore counts the users of a display.
class SharedDisplay {
 public:
  explicit SharedDisplay(EGLDisplay display) : display_(display) {
    const std::lock_guard lock(Mutex());
    ++Users()[display_];
  }
  ~SharedDisplay() {
    const std::lock_guard lock(Mutex());
    if (--Users()[display_] > 0) return;
    Users().erase(display_);
    eglTerminate(display_);
  }
  SharedDisplay(const SharedDisplay&) = delete;
  SharedDisplay& operator=(const SharedDisplay&) = delete;

  EGLDisplay Get() const { return display_; }

 private:
  static std::mutex& Mutex() {
    static std::mutex mutex;
    return mutex;
  }
  static std::map<EGLDisplay, int>& Users() {
    static std::map<EGLDisplay, int> users;
    return users;
  }

  const EGLDisplay display_;
};

class EglContext final : public Context {
 public:
  explicit EglContext(EGLDisplay display) : display_(display) {}

  ~EglContext() override {
    eglMakeCurrent(display_.Get(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_.Get(), context_);
  }

  absl::Status Open(std::string device) {
    EGLint major = 0;
    EGLint minor = 0;
    if (eglInitialize(display_.Get(), &major, &minor) == EGL_FALSE) {
      return absl::UnavailableError("its EGL driver cannot be initialised");
    }
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) {
      return absl::UnavailableError("its EGL driver has no desktop OpenGL");
    }
    const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0,
                                        EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglChooseConfig(display_.Get(), config_attributes, &config, 1, &count) == EGL_FALSE ||
        count == 0) {
      config = nullptr;  // allowed by EGL_KHR_no_config_context
    }
    Make(config);
    if (context_ == EGL_NO_CONTEXT) {
      return absl::UnavailableError("it offers no OpenGL 4.5 core context");
    }
    if (eglMakeCurrent(display_.Get(), EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
      return absl::UnavailableError("its context cannot be used without a surface");
    }
    GLint strategy = GL_NO_RESET_NOTIFICATION;
    glGetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
    info_ = {std::move(device), GlString(GL_RENDERER), GlString(GL_VERSION),
             strategy == GL_LOSE_CONTEXT_ON_RESET};
    return absl::OkStatus();
  }

  const ContextInfo& Info() const override { return info_; }

 private:
  // Creates a robust context if the driver offers one, because a robust context reports that the
  // device was reset. Otherwise it creates a plain context.
  void Make(EGLConfig config) {
    const std::vector<EGLint> plain = {
        EGL_CONTEXT_MAJOR_VERSION,       4,
        EGL_CONTEXT_MINOR_VERSION,       5,
        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
    const auto make = [&](std::initializer_list<EGLint> more) {
      std::vector<EGLint> attributes = plain;
      attributes.insert(attributes.end(), more);
      attributes.push_back(EGL_NONE);
      context_ = eglCreateContext(display_.Get(), config, EGL_NO_CONTEXT, attributes.data());
      return context_ != EGL_NO_CONTEXT;
    };
    if (epoxy_egl_version(display_.Get()) >= 15 &&
        make({EGL_CONTEXT_OPENGL_ROBUST_ACCESS, EGL_TRUE,
              EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET})) {
      return;
    }
    if (epoxy_has_egl_extension(display_.Get(), "EGL_EXT_create_context_robustness") &&
        make({EGL_CONTEXT_OPENGL_ROBUST_ACCESS_EXT, EGL_TRUE,
              EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT, EGL_LOSE_CONTEXT_ON_RESET_EXT})) {
      return;
    }
    make({});
  }

  SharedDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
  ContextInfo info_;
};

// libepoxy cannot resolve the core function eglGetPlatformDisplay before a display exists. It can
// resolve the EXT entry point, which is therefore used.
EGLDisplay PlatformDisplay(EGLenum platform, void* native) {
  return eglGetPlatformDisplayEXT(platform, native, nullptr);
}

// Returns only GPUs. Mesa also lists its software renderer as a device, which is left out.
std::vector<EGLDeviceEXT> GpuDevices() {
  std::vector<EGLDeviceEXT> gpus;
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base") &&
      !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration")) {
    return gpus;
  }
  EGLDeviceEXT devices[kMaxDevices];
  EGLint count = 0;
  if (eglQueryDevicesEXT(kMaxDevices, devices, &count) == EGL_FALSE) return gpus;
  for (EGLint i = 0; i < count; ++i) {
    const char* extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
    const absl::string_view text = extensions == nullptr ? "" : extensions;
    if (text.find("EGL_MESA_device_software") == absl::string_view::npos) {
      gpus.push_back(devices[i]);
    }
  }
  return gpus;
}

absl::StatusOr<std::unique_ptr<Context>> OpenGpu(EGLDeviceEXT device, std::size_t index) {
  EGLDisplay display = PlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device);
  if (display == EGL_NO_DISPLAY) return absl::UnavailableError("it has no EGL display");
  auto context = std::make_unique<EglContext>(display);
  THUNDERHEAD_RETURN_IF_ERROR(context->Open(absl::StrCat("gpu ", index)));
  return context;
}

absl::StatusOr<std::unique_ptr<Context>> OpenSoftware() {
  // Without this variable, Mesa's surfaceless platform would choose a GPU that Mesa drives,
  // although "software" was requested.
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  EGLDisplay display =
      PlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY));
  absl::Status status = absl::UnavailableError("there is no surfaceless EGL platform");
  if (display != EGL_NO_DISPLAY) {
    auto context = std::make_unique<EglContext>(display);
    status = context->Open("software");
    if (status.ok() && DrawsInSoftware()) return context;
    // This is an error, because the user asked for software: a driver other than Mesa's may also
    // offer the surfaceless platform.
    if (status.ok()) {
      status = absl::UnavailableError(
          absl::StrCat("the surfaceless EGL platform draws on ", context->Info().renderer));
    }
  }
  return absl::UnavailableError(
      absl::StrCat("software rendering is not available: ", status.message(),
                   "; install Mesa's software renderer (Debian: libegl1 libgl1-mesa-dri)"));
}

absl::StatusOr<std::unique_ptr<Context>> OpenNumberedGpu(const std::vector<EGLDeviceEXT>& gpus,
                                                         std::size_t index) {
  if (index >= gpus.size()) {
    return absl::NotFoundError(absl::StrCat(
        "device ", index, " was asked for, but EGL finds ", gpus.size(),
        " GPU(s), counted from 0; use --device software, or install the GPU's EGL driver"));
  }
  auto context = OpenGpu(gpus[index], index);
  if (context.ok()) return context;
  return absl::UnavailableError(absl::StrCat("device ", index,
                                             " cannot be used: ", context.status().message(),
                                             "; check the GPU's driver, or use --device software"));
}

absl::StatusOr<std::unique_ptr<Context>> OpenAny(const std::vector<EGLDeviceEXT>& gpus) {
  for (std::size_t i = 0; i < gpus.size(); ++i) {
    auto context = OpenGpu(gpus[i], i);
    if (context.ok()) return context;
    spdlog::info("gpu {} is not used: {}", i, std::string(context.status().message()));
  }
  return OpenSoftware();
}

}  // namespace

absl::StatusOr<std::unique_ptr<Context>> Context::Create(std::string_view device) {
  absl::StatusOr<std::unique_ptr<Context>> context = absl::UnknownError("");
  if (device == "software") {
    context = OpenSoftware();
  } else if (device == "auto") {
    context = OpenAny(GpuDevices());
  } else {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(device.data(), device.data() + device.size(), index);
    if (error != std::errc() || end != device.data() + device.size()) {
      return absl::InvalidArgumentError(
          absl::StrCat("device is '", absl::string_view(device.data(), device.size()),
                       "'; it must be 'auto', 'software' or a GPU's number"));
    }
    context = OpenNumberedGpu(GpuDevices(), index);
  }
  if (context.ok()) {
    const ContextInfo& info = (*context)->Info();
    spdlog::info("drawing on {}: {}, OpenGL {}{}", info.device, info.renderer, info.version,
                 info.tells_of_loss ? "" : "; its driver does not report when the device is reset");
  }
  return context;
}

}  // namespace thunderhead::gl
