!> Bodies that friction cannot hold: loads on floating motions that no forces within the cones of
!> Coulomb's law balance, however the bodies deform.
!>
!> With f the contact forces, C their work on the floating motions and m the load on these: the
!> least |C'f + m| over the cones, by projected gradients with momentum. What is left of it is a
!> motion that the load drives and that no force of the cones works against (Farkas): with that
!> motion in hand the answer does not depend on how far the iteration came.
module lopin_cone_balance
   use lopin_kinds, only : wp
   use lopin_dense, only : symmetric_eigen
   use lopin_friction, only : law_of
   use lopin_friction_rows, only : friction_points_type
   implicit none
   private
   public :: find_unheld_motion

   integer, parameter :: most_iterations = 4000, look_every = 50
   !> A balance that takes forces so much larger than the load is none.
   real(wp), parameter :: beyond_load = 1.0e4_wp
   real(wp), parameter :: balanced = 1.0e-9_wp   !! what is left beside the load

contains

   !> A motion that the load drives and no force within the cones resists.
   subroutine find_unheld_motion(c, bilateral, points, load, motion, found)
      real(wp), intent(in) :: c(:, :)              !! (nrow, nq)
      logical, intent(in) :: bilateral(:)          !! (nrow)
      type(friction_points_type), intent(in) :: points
      real(wp), intent(in) :: load(:)              !! (nq)
      real(wp), allocatable, intent(out) :: motion(:)   !! (nq)
      logical, intent(out) :: found
      real(wp), allocatable :: axes(:, :), value(:), a(:, :), m(:), f(:), last(:), ahead(:), left(:)
      real(wp) :: speed, next, resisted
      integer :: i, status

      found = .false.
      if (size(load) == 0) return
      allocate (value(size(load)), f(size(c, 1)), source=0.0_wp)
      axes = matmul(transpose(c), c)
      call symmetric_eigen(axes, value, status)
      if (status /= 0) return
      if (.not. value(1) > 1.0e-10_wp*value(size(value))) return
      ! Motions of which the rows see as much of each.
      axes = axes/spread(sqrt(value), 1, size(value))
      a = matmul(c, axes)
      m = matmul(load, axes)
      ahead = f
      speed = 1.0_wp
      do i = 1, most_iterations
         last = f
         left = matmul(ahead, a) + m
         f = ahead - matmul(a, left)
         call project(f, bilateral, points)
         next = 0.5_wp*(1.0_wp + sqrt(1.0_wp + 4.0_wp*speed**2))
         ahead = f + (speed - 1.0_wp)/next*(f - last)
         speed = next
         if (mod(i, look_every) > 0) cycle
         left = matmul(f, a) + m
         if (.not. norm2(left) > balanced*norm2(m)) return
         resisted = resistance(matmul(a, left), bilateral, points)
         found = dot_product(m, left) > beyond_load*norm2(m)*resisted
         if (found) exit
      end do
      if (found) motion = matmul(axes, left)
   end subroutine find_unheld_motion

   !> The nearest forces within the cones.
   pure subroutine project(f, bilateral, points)
      real(wp), intent(inout) :: f(:)
      logical, intent(in) :: bilateral(:)
      type(friction_points_type), intent(in) :: points
      real(wp) :: across, along, mu
      integer :: k

      do k = 1, points%n
         associate (n => points%normal(k), from => points%tangent(k), &
            & to => points%tangent(k) + points%nt - 1)
            mu = cone_of(points, k)
            if (bilateral(n) .or. mu < 0.0_wp) cycle
            along = norm2(f(from:to))
            if (along <= mu*f(n)) cycle
            across = max(0.0_wp, (f(n) + mu*along)/(1.0_wp + mu**2))
            f(n) = across
            if (along > 0.0_wp) f(from:to) = mu*across/along*f(from:to)
         end associate
      end do
      ! Rows along the faces have been brought into their cones.
      call press_only(f, bilateral, points)
   end subroutine project

   pure subroutine press_only(f, bilateral, points)
      real(wp), intent(inout) :: f(:)
      logical, intent(in) :: bilateral(:)
      type(friction_points_type), intent(in) :: points

      where (.not. (bilateral .or. along_faces(points, size(f)))) f = max(f, 0.0_wp)
   end subroutine press_only

   !> The most that a unit of force within the cones works against a motion of the rows.
   pure real(wp) function resistance(moved, bilateral, points)
      real(wp), intent(in) :: moved(:)             !! (nrow) opening and sliding
      logical, intent(in) :: bilateral(:)
      type(friction_points_type), intent(in) :: points
      logical :: along(size(moved))
      real(wp) :: mu
      integer :: k

      along = along_faces(points, size(moved))
      resistance = maxval(-moved, mask=.not. along)
      resistance = max(0.0_wp, resistance, maxval(abs(moved), mask=bilateral))
      do k = 1, points%n
         associate (n => points%normal(k), from => points%tangent(k), &
            & to => points%tangent(k) + points%nt - 1)
            mu = cone_of(points, k)
            if (bilateral(n) .or. mu < 0.0_wp) then
               resistance = max(resistance, norm2(moved(from:to)))
            else
               resistance = max(resistance, mu*norm2(moved(from:to)) - moved(n))
            end if
         end associate
      end do
   end function resistance

   pure function along_faces(points, nrow) result(along)
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: nrow
      logical :: along(nrow)
      integer :: k

      along = .false.
      do k = 1, points%n
         along(points%tangent(k):points%tangent(k) + points%nt - 1) = .true.
      end do
   end function along_faces

   !> Shear over pressure that a point bears at most; -1: not bound by the pressure.
   pure real(wp) function cone_of(points, k) result(mu)
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k

      mu = -1.0_wp
      associate (law => points%law(k))
         if (law%rough .or. .not. any(law%law == [law_of%coulomb, law_of%orowan])) return
         mu = max(law%mu, law%mu_static)
      end associate
   end function cone_of
end module lopin_cone_balance
