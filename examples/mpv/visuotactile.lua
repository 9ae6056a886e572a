-- SPDX-License-Identifier: LGPL-2.1-or-later
--
-- The chair follows this mpv: copy this file to ~/.config/mpv/scripts. A visuotactile-follow that runs
-- already is used; else one is started, and ends with mpv. What it is started with:
-- script-opts=visuotactile-options=--driver=gamepad --sound=film
--
-- Ctrl+Alt+Right: all is felt 10 ms later, Ctrl+Alt+Left: earlier, Ctrl+Alt+I: what is felt.
local utils = require "mp.utils"
local settings = { options = "" }
require("mp.options").read_options(settings, "visuotactile")
local program = "visuotactile-follow"

-- Without a socket of the user's, that at which a visuotactile-follow looks by itself.
local function socket()
    local folder = os.getenv("XDG_RUNTIME_DIR")
    if mp.get_property("input-ipc-server") == "" and folder then
        mp.set_property("input-ipc-server", utils.join_path(folder, "mpv.sock"))
    end
    return mp.get_property("input-ipc-server")
end

local function run(option, done)
    mp.command_native_async({ name = "subprocess", args = { program, option }, playback_only = false,
                              capture_stdout = true, capture_stderr = true },
        function(success, result)
            local works = success and result.status == 0
            done(works, works and result.stdout or (result.stderr ~= "" and result.stderr or program .. " is missing"))
        end)
end

local function show(option)
    return function() run(option, function(_, text) mp.osd_message(text, 4) end) end
end

local path = socket()
run("--status", function(works, text)
    if works then return end
    if path == "" then mp.msg.error("no socket: neither input-ipc-server nor XDG_RUNTIME_DIR is set") return end
    local args = { program, "--mpv=" .. path, "--once" }
    for option in settings.options:gmatch("%S+") do table.insert(args, option) end
    -- Detached: mpv would kill it, motors and all. It ends when mpv's socket is gone.
    mp.command_native_async({ name = "subprocess", args = args, playback_only = false, detach = true }, function() end)
end)

mp.add_key_binding("Ctrl+Alt+RIGHT", "later", show("--nudge=10"))
mp.add_key_binding("Ctrl+Alt+LEFT", "earlier", show("--nudge=-10"))
mp.add_key_binding("Ctrl+Alt+i", "status", show("--status"))
