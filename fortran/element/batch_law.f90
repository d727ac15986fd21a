!> Hencky's law with its radial return at one Gauss point of each element of a batch.
!>
!> What modules hyperelastic and log_strain compute, in the same operations, with the element as the
!> fastest index. Principal axes are found by rotations of Jacobi that leave an element alone once
!> it has them: at several points at once, for each rotation waits for the roots of the one before.
module lopin_batch_law
   use lopin_kinds, only : wp
   use lopin_element_batch, only : lanes, most
   use lopin_log_strain, only : log_one_plus, exp_minus_one, first_axis, second_axis, series_below
   use lopin_hyperelastic, only : solid_law_type, past_type, answer_of
   use lopin_radial_return, only : return_type
   implicit none
   private
   public :: law_lanes_type, respond_in_lanes, strain_in_lanes, flow_lanes_type, flow_in_lanes
   public :: frame_lanes_type, find_frames

   !> Kirchhoff stress, energy per reference volume, spatial tangent.
   type :: law_lanes_type
      real(wp) :: stress(lanes, 6)         !! [stress]
      real(wp) :: energy(lanes)            !! [stress]
      real(wp) :: tangent(lanes, 6, 6)     !! [stress]
   end type law_lanes_type

   !> Plastic flow of a trial: what modules hyperelastic and material_point keep of it.
   type :: flow_lanes_type
      real(wp) :: step(lanes)              !! of plastic strain
      real(wp) :: stress(lanes)            !! von Mises, at the end [stress]
      real(wp) :: metric(lanes, 6)         !! what is added to the plastic metric
   end type flow_lanes_type

   !> Principal directions and logarithmic strains.
   type :: frame_lanes_type
      real(wp) :: axis(lanes, 3, 3)        !! third index: direction
      real(wp) :: change(lanes, 3)         !! b - 1 along each
      real(wp) :: e(lanes, 3)              !! logarithmic strain along each
   end type frame_lanes_type

   !> What the return leaves of the trial deviator.
   type :: return_lanes_type
      real(wp), dimension(lanes) :: secant, along, kept, square, step, stress
      real(wp) :: deviator(lanes, 3)
   end type return_lanes_type

   integer, parameter :: at_a_time = most/2, together = at_a_time*lanes   !! points; their elements

contains

   !> Stress and energy and, if asked for, tangent of a deformation.
   pure subroutine respond_in_lanes(law, frame, volume, strain, offset, dt, with_tangent, answer)
      type(solid_law_type), intent(in) :: law
      type(frame_lanes_type), intent(in) :: frame   !! of the elastic part of a trial
      real(wp), intent(in) :: volume(lanes)         !! J - 1 that counts
      real(wp), intent(in) :: strain(lanes)         !! plastic strain of the accepted state
      real(wp), intent(in) :: offset(lanes)         !! elastic ln J beyond that of the deformation
      real(wp), intent(in) :: dt                    !! [time]
      logical, intent(in) :: with_tangent
      type(law_lanes_type), intent(inout) :: answer
      type(return_lanes_type) :: back
      real(wp) :: dilatation(lanes), principal(lanes, 3)
      integer :: k, l

      do l = 1, lanes
         dilatation(l) = log_one_plus(volume(l)) + offset(l)
      end do
      call return_in_lanes(law, frame, strain, dt, back)
      do k = 1, 3
         principal(:, k) = back%secant*back%deviator(:, k) + law%bulk*dilatation
      end do
      call turn_stress(frame%axis, principal, answer%stress)
      answer%energy = 0.5_wp*law%bulk*dilatation**2 + law%shear*back%kept**2*back%square
      if (with_tangent) call find_tangent(law%bulk, frame, back, principal, answer%tangent)
   end subroutine respond_in_lanes

   !> Logarithmic strain of the deformation scaled to a change of volume; engineering shears.
   pure subroutine strain_in_lanes(frame, volume, strain)
      type(frame_lanes_type), intent(in) :: frame
      real(wp), intent(in) :: volume(lanes)         !! J - 1
      real(wp), intent(out) :: strain(lanes, 6)
      real(wp) :: shift(lanes), e(lanes, 3)
      integer :: k, l

      do l = 1, lanes
         shift(l) = log_one_plus(volume(l))
      end do
      shift = (shift - (frame%e(:, 1) + frame%e(:, 2) + frame%e(:, 3)))/3.0_wp
      do k = 1, 3
         e(:, k) = frame%e(:, k) + shift
      end do
      call turn_stress(frame%axis, e, strain)
      strain(:, 4:) = 2.0_wp*strain(:, 4:)
   end subroutine strain_in_lanes

   !> Plastic flow of a trial deformation.
   pure subroutine flow_in_lanes(law, frame, inverse, strain, dt, flow)
      type(solid_law_type), intent(in) :: law
      type(frame_lanes_type), intent(in) :: frame   !! of the elastic part of a trial
      real(wp), intent(in) :: inverse(lanes, 3, 3)  !! of F
      real(wp), intent(in) :: strain(lanes)         !! plastic strain of the accepted state
      real(wp), intent(in) :: dt                    !! [time]
      type(flow_lanes_type), intent(out) :: flow
      type(return_lanes_type) :: back
      real(wp) :: n(lanes, 3, 3), taken(lanes, 3)
      integer :: i, k, l

      call return_in_lanes(law, frame, strain, dt, back)
      flow%step = back%step
      flow%stress = back%stress
      flow%metric = 0.0_wp
      if (.not. any(back%step > 0.0_wp)) return
      do k = 1, 3
         do l = 1, lanes
            taken(l, k) = (1.0_wp + frame%change(l, k)) &
               & *exp_minus_one(-2.0_wp*(1.0_wp - back%kept(l))*back%deviator(l, k))
         end do
         do i = 1, 3
            n(:, i, k) = inverse(:, i, 1)*frame%axis(:, 1, k) &
               & + inverse(:, i, 2)*frame%axis(:, 2, k) + inverse(:, i, 3)*frame%axis(:, 3, k)
         end do
      end do
      call turn_stress(n, taken, flow%metric)
   end subroutine flow_in_lanes

   !> The trial deviators and their returns.
   pure subroutine return_in_lanes(law, frame, strain, dt, back)
      type(solid_law_type), intent(in) :: law
      type(frame_lanes_type), intent(in) :: frame
      real(wp), intent(in) :: strain(lanes), dt
      type(return_lanes_type), intent(out) :: back
      type(return_type) :: one
      type(past_type) :: past
      real(wp) :: mean(lanes)
      integer :: k, l

      mean = (frame%e(:, 1) + frame%e(:, 2) + frame%e(:, 3))/3.0_wp
      do k = 1, 3
         back%deviator(:, k) = frame%e(:, k) - mean
      end do
      back%square = back%deviator(:, 1)**2 + back%deviator(:, 2)**2 + back%deviator(:, 3)**2
      past%dt = dt
      do l = 1, lanes
         past%strain = strain(l)
         one = answer_of(law, past, sqrt(back%square(l)))
         back%secant(l) = one%secant
         back%along(l) = one%along
         back%kept(l) = one%kept
         back%step(l) = one%step
         back%stress(l) = one%stress
      end do
   end subroutine return_in_lanes

   !> Principal directions of b at all points of a batch, a few of them at a time.
   pure subroutine find_frames(npoint, change, frame)
      integer, intent(in) :: npoint
      real(wp), intent(in) :: change(lanes, 3, 3, npoint)   !! b - 1
      type(frame_lanes_type), intent(inout) :: frame(npoint)
      real(wp), dimension(together, 3) :: b, off   ! off the diagonal by the direction across
      real(wp) :: n(together, 3, 3)
      integer :: first, last, at, i, k, l

      do first = 1, npoint, at_a_time
         last = min(first + at_a_time - 1, npoint)
         do i = first, last
            at = lanes*(i - first)
            do k = 1, 3
               b(at + 1:at + lanes, k) = change(:, k, k, i)
            end do
            off(at + 1:at + lanes, 1) = change(:, 2, 3, i)
            off(at + 1:at + lanes, 2) = change(:, 1, 3, i)
            off(at + 1:at + lanes, 3) = change(:, 1, 2, i)
         end do
         call find_axes(lanes*(last - first + 1), b, off, n)
         do i = first, last
            at = lanes*(i - first)
            do k = 1, 3
               frame(i)%axis(:, :, k) = n(at + 1:at + lanes, :, k)
               frame(i)%change(:, k) = b(at + 1:at + lanes, k)
               do l = 1, lanes
                  frame(i)%e(l, k) = 0.5_wp*log_one_plus(frame(i)%change(l, k))
               end do
            end do
         end do
      end do
   end subroutine find_frames

   !> Principal directions and values of b; directions decoupled from the others stay in place.
   pure subroutine find_axes(m, b, off, n)
      integer, intent(in) :: m                 !! how many count
      real(wp), dimension(together, 3), intent(inout) :: b, off
      real(wp), intent(out) :: n(together, 3, 3)
      logical :: active(together), plane(together)
      integer, parameter :: most_sweeps = 20
      integer :: sweep, k

      n = 0.0_wp
      do k = 1, 3
         n(:, k, k) = 1.0_wp
      end do
      plane = .false.
      active = .false.
      plane(:m) = .not. abs(off(:m, 2)) + abs(off(:m, 1)) > 0.0_wp
      active(:m) = .true.
      do sweep = 1, most_sweeps
         active(:m) = active(:m) .and. abs(off(:m, 3)) + abs(off(:m, 2)) + abs(off(:m, 1)) &
            & > 0.01_wp*epsilon(1.0_wp)*(abs(b(:m, 1)) + abs(b(:m, 2)) + abs(b(:m, 3)))
         if (sweep == 1) active = active .or. plane
         if (sweep == 2) active = active .and. .not. plane
         if (.not. any(active(:m))) exit
         call rotate(m, active, 1, 2, b, off, n)
         call rotate(m, active, 1, 3, b, off, n)
         call rotate(m, active, 2, 3, b, off, n)
      end do
   end subroutine find_axes

   !> One rotation of Jacobi in the plane of two directions, of the elements that want it. Loops
   !> without branches: these are vector instructions.
   pure subroutine rotate(m, active, p, q, b, off, n)
      integer, intent(in) :: m, p, q
      logical, intent(in) :: active(together)
      real(wp), dimension(together, 3), intent(inout) :: b, off
      real(wp), intent(inout) :: n(together, 3, 3)
      real(wp), dimension(together) :: c, s, shear, half, radius
      real(wp) :: t, turned
      integer :: i, l, r

      r = 6 - p - q
      shear(:m) = merge(off(:m, r), 0.0_wp, active(:m))
      off(:m, r) = 0.0_wp
      do l = 1, m
         half(l) = 0.5_wp*(b(l, q) - b(l, p))
         radius(l) = sqrt(half(l)**2 + shear(l)**2)
      end do
      ! What is too small to have a square is no shear.
      shear(:m) = merge(shear(:m), 0.0_wp, radius(:m) > 0.0_wp)
      radius(:m) = merge(radius(:m), 1.0_wp, radius(:m) > 0.0_wp)
      do l = 1, m
         t = shear(l)/(half(l) + sign(radius(l), half(l)))
         c(l) = 1.0_wp/sqrt(1.0_wp + t*t)
         s(l) = t*c(l)
         b(l, p) = b(l, p) - t*shear(l)
         b(l, q) = b(l, q) + t*shear(l)
         turned = off(l, q)
         off(l, q) = c(l)*turned - s(l)*off(l, p)
         off(l, p) = s(l)*turned + c(l)*off(l, p)
      end do
      do i = 1, 3
         do l = 1, m
            turned = n(l, i, p)
            n(l, i, p) = c(l)*turned - s(l)*n(l, i, q)
            n(l, i, q) = s(l)*turned + c(l)*n(l, i, q)
         end do
      end do
   end subroutine rotate

   !> Tensor of given principal values: xx yy zz xy xz yz.
   pure subroutine turn_stress(n, principal, stress)
      real(wp), intent(in) :: n(lanes, 3, 3), principal(lanes, 3)
      real(wp), intent(out) :: stress(lanes, 6)
      integer :: r

      do r = 1, 6
         stress(:, r) = principal(:, 1)*n(:, first_axis(r), 1)*n(:, second_axis(r), 1) &
            & + principal(:, 2)*n(:, first_axis(r), 2)*n(:, second_axis(r), 2) &
            & + principal(:, 3)*n(:, first_axis(r), 3)*n(:, second_axis(r), 3)
      end do
   end subroutine turn_stress

   !> Spatial tangent from the slopes of the principal stresses and the secants of shear.
   pure subroutine find_tangent(bulk, frame, back, principal, tangent)
      real(wp), intent(in) :: bulk                   !! [stress]
      type(frame_lanes_type), intent(in) :: frame
      type(return_lanes_type), intent(in) :: back
      real(wp), intent(in) :: principal(lanes, 3)    !! [stress]
      real(wp), intent(out) :: tangent(lanes, 6, 6)
      real(wp) :: normal(lanes, 3, 3), shear(lanes, 3), d(lanes), below(lanes), square(lanes)
      logical :: near(lanes)
      integer :: i, k

      square = merge(back%square, 1.0_wp, abs(back%along) > 0.0_wp)
      do k = 1, 3
         do i = 1, 3
            normal(:, i, k) = bulk - back%secant/3.0_wp
            if (i == k) normal(:, i, k) = normal(:, i, k) + back%secant
            normal(:, i, k) = normal(:, i, k) &
               & + (back%along*back%deviator(:, k)/square)*back%deviator(:, i)
         end do
      end do
      do k = 1, 3
         normal(:, k, k) = normal(:, k, k) - 2.0_wp*principal(:, k)
         associate (p => first_axis(k + 3), q => second_axis(k + 3))
            d = frame%e(:, p) - frame%e(:, q)
            near = abs(d) < series_below
            below = merge(1.0_wp, frame%change(:, p) - frame%change(:, q), near)
            d = merge(1.0_wp + d**2/3.0_wp - d**4/45.0_wp, &
               & d*(2.0_wp + frame%change(:, p) + frame%change(:, q))/below, near)
            shear(:, k) = 0.5_wp*(back%secant*d - principal(:, p) - principal(:, q))
         end associate
      end do
      call turn_tangent(frame%axis, normal, shear, tangent)
   end subroutine find_tangent

   !> Tangent of principal axes, in x, y and z; see turn_in_space of module log_strain.
   pure subroutine turn_tangent(axis, normal, shear, tangent)
      real(wp), intent(in) :: axis(lanes, 3, 3), normal(lanes, 3, 3), shear(lanes, 3)
      real(wp), intent(out) :: tangent(lanes, 6, 6)
      real(wp), dimension(lanes, 6, 6) :: map, part
      integer :: k, l, r

      do k = 1, 6
         associate (p => first_axis(k), q => second_axis(k))
            do r = 1, 6
               map(:, r, k) = axis(:, first_axis(r), p)*axis(:, second_axis(r), q)
               if (k > 3) map(:, r, k) = map(:, r, k) &
                  & + axis(:, first_axis(r), q)*axis(:, second_axis(r), p)
            end do
         end associate
      end do
      do k = 1, 3
         do r = 1, 6
            part(:, r, k) = normal(:, 1, k)*map(:, r, 1) + normal(:, 2, k)*map(:, r, 2) &
               & + normal(:, 3, k)*map(:, r, 3)
            part(:, r, k + 3) = shear(:, k)*map(:, r, k + 3)
         end do
      end do
      do k = 1, 6
         do r = 1, 6
            do l = 1, lanes
               tangent(l, r, k) = part(l, r, 1)*map(l, k, 1) + part(l, r, 2)*map(l, k, 2) &
                  & + part(l, r, 3)*map(l, k, 3) + part(l, r, 4)*map(l, k, 4) &
                  & + part(l, r, 5)*map(l, k, 5) + part(l, r, 6)*map(l, k, 6)
            end do
         end do
      end do
   end subroutine turn_tangent
end module lopin_batch_law
