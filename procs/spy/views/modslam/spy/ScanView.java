// SPDX-License-Identifier: BSD-3-Clause
package modslam.spy;

import bot_core.planar_lidar_t;
import java.awt.Color;
import java.awt.Graphics2D;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/** A sweep as the laser sees it, the laser in the middle. */
public class ScanView implements SpyPlugin {
    @Override public boolean canHandle(long fingerprint) { return fingerprint == planar_lidar_t.LCM_FINGERPRINT; }
    @Override public Action getAction(JDesktopPane desktop, ChannelData channel) {
        String name = MapPanel.nameOf(channel, "LASER");
        return MapPanel.window(name + " scan", name, Panel::new);
    }

    static class Panel extends MapPanel {
        private planar_lidar_t scan;
        @Override void take(String channel, LCMDataInputStream bytes) throws Exception {
            scan = new planar_lidar_t(bytes);
            for (int i = 0; i < scan.nranges; i++) see(x(i), y(i));
        }
        private double x(int i) { return scan.ranges[i] * Math.cos(scan.rad0 + i * scan.radstep); }
        private double y(int i) { return scan.ranges[i] * Math.sin(scan.rad0 + i * scan.radstep); }
        @Override void draw(Graphics2D g) {
            if (scan == null) return;
            g.setColor(new Color(0xe0533d));
            for (int i = 0; i < scan.nranges; i++) dot(g, x(i), y(i), 4);
            g.setColor(new Color(0x12424a));
            dot(g, 0, 0, 9);
        }
    }
}
