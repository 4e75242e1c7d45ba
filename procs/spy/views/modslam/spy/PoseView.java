// SPDX-License-Identifier: BSD-3-Clause
package modslam.spy;

import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.geom.Path2D;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import modslam.pose_estimate_t;

/** The trace of POSE since the window was opened. */
public class PoseView implements SpyPlugin {
    @Override public boolean canHandle(long fingerprint) { return fingerprint == pose_estimate_t.LCM_FINGERPRINT; }
    @Override public Action getAction(JDesktopPane desktop, ChannelData channel) {
        String name = MapPanel.nameOf(channel, "POSE");
        return MapPanel.window(name + " trace", name, Panel::new);
    }

    static class Panel extends MapPanel {
        private final Path2D trace = new Path2D.Double();
        private double[] last;
        @Override void take(String channel, LCMDataInputStream bytes) throws Exception {
            double[] pose = new pose_estimate_t(bytes).T_map_base;
            if (last == null) trace.moveTo(pose[0], pose[1]); else trace.lineTo(pose[0], pose[1]);
            last = pose;
            see(pose[0], pose[1]);
        }
        @Override void draw(Graphics2D g) {
            if (last == null) return;
            g.setColor(new Color(0x1f6f78));
            g.setStroke(width(2));
            g.draw(trace);
            g.setColor(new Color(0x12424a));
            dot(g, last[0], last[1], 9);
        }
    }
}
