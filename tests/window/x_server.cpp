#include "tests/window/x_server.hpp"

#include <gtest/gtest.h>
// after gtest, which Xlib's macros would break
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <array>
#include <chrono>
#include <csignal>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/support/required.hpp"

namespace lumo::testing_support {
namespace {

using namespace std::chrono_literals;

/// The display number that the server writes once it listens; empty where it ends or is silent.
std::string read_number(int pipe) {
    std::string number;
    pollfd ready{pipe, POLLIN, 0};
    while (poll(&ready, 1, 30'000) == 1) {
        char letter = 0;
        if (read(pipe, &letter, 1) != 1) return {};
        if (letter == '\n') return number;
        number += letter;
    }
    return {};
}

XWindow find_below(Display* display, XWindow parent, const std::string& title) {
    XWindow root = 0, above = 0, found = 0;
    XWindow* children = nullptr;
    unsigned count = 0;
    if (!XQueryTree(display, parent, &root, &above, &children, &count)) return 0;
    for (unsigned i = 0; i < count && !found; ++i) {
        char* name = nullptr;
        if (XFetchName(display, children[i], &name) && name == title) found = children[i];
        if (name) XFree(name);
        if (!found) found = find_below(display, children[i], title);
    }
    if (children) XFree(children);
    return found;
}

}  // namespace

std::unique_ptr<XServer> XServer::start() {
    auto server = try_start();
    if (!server && apis_required())
        [] { FAIL() << "Xvfb does not start: install xvfb"; }();  // fatal: the test goes no further
    return server;
}

std::unique_ptr<XServer> XServer::try_start() {
    std::array<int, 2> pipe{};
    if (::pipe(pipe.data()) != 0) return nullptr;
    const std::string number_to = std::to_string(pipe[1]);
    const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
    const pid_t process = fork();
    if (process == 0) {
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (!freopen("/dev/null", "w", stderr)) _exit(127);
        execlp("Xvfb", "Xvfb", "-displayfd", number_to.c_str(), "-screen", "0", screen.c_str(), "-nolisten",
               "tcp", "-noreset", static_cast<char*>(nullptr));
        _exit(127);
    }
    ::close(pipe[1]);
    const std::string number = read_number(pipe[0]);
    ::close(pipe[0]);
    Display* display = number.empty() ? nullptr : XOpenDisplay((":" + number).c_str());
    if (!display) {
        kill(process, SIGTERM);
        waitpid(process, nullptr, 0);
        return nullptr;
    }
    setenv("DISPLAY", (":" + number).c_str(), 1);
    // A window that goes while it is looked for is no error.
    XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
    return std::unique_ptr<XServer>(new XServer(process, display));
}

XServer::~XServer() {
    XCloseDisplay(display_);
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    unsetenv("DISPLAY");
}

XWindow XServer::find(const std::string& title) const {
    for (int i = 0; i < 500; ++i) {
        if (XWindow found = find_below(display_, DefaultRootWindow(display_), title)) return found;
        std::this_thread::sleep_for(20ms);
    }
    return 0;
}

std::optional<Picture> XServer::screenshot(XWindow window) const {
    XWindowAttributes shape;
    if (!XGetWindowAttributes(display_, window, &shape)) return {};
    int x = 0, y = 0;
    XWindow child = 0;
    XTranslateCoordinates(display_, window, shape.root, 0, 0, &x, &y, &child);
    XImage* image = XGetImage(display_, shape.root, x, y, unsigned(shape.width), unsigned(shape.height),
                              AllPlanes, ZPixmap);
    if (!image) return {};
    Picture picture{uint32_t(shape.width), uint32_t(shape.height)};
    for (int row = 0; row < shape.height; ++row)
        for (int column = 0; column < shape.width; ++column)
            picture.pixels.push_back(uint32_t(XGetPixel(image, column, row)) & 0xffffff);
    XDestroyImage(image);
    return picture;
}

void XServer::resize(XWindow window, uint32_t new_width, uint32_t new_height) const {
    XResizeWindow(display_, window, new_width, new_height);
    XFlush(display_);
}

// What a window manager does (Inter-Client Communication Conventions, 4.1.3.1 and 4.1.4).

void XServer::set_state(XWindow window, long state) const {
    const Atom property = XInternAtom(display_, "WM_STATE", False);
    const std::array<long, 2> value{state, None};
    XChangeProperty(display_, window, property, property, 32, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(value.data()), int(value.size()));
    XFlush(display_);
}

void XServer::minimise(XWindow window) const {
    XUnmapWindow(display_, window);
    set_state(window, IconicState);
}

void XServer::restore(XWindow window) const {
    XMapWindow(display_, window);
    set_state(window, NormalState);
}

void XServer::close(XWindow window) const {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = window;
    event.xclient.message_type = XInternAtom(display_, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] = long(XInternAtom(display_, "WM_DELETE_WINDOW", False));
    event.xclient.data.l[1] = CurrentTime;
    XSendEvent(display_, window, False, NoEventMask, &event);
    XFlush(display_);
}

}  // namespace lumo::testing_support
