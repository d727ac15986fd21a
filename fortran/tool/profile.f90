!> A plane profile of lines, circular arcs and parabolas: how it is built and rounded.
!>
!> Travelled from START on, the profile has its outward side on its LEFT (`outward_side`).
module lopin_profile
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, location_type, nowhere
   use lopin_tool, only : coincidence
   implicit none
   private
   public :: profile_type, segment_type, segment_card_type, segment_kind, outward_side
   public :: new_profile, left_of, cross_2d, smooth_angle, parabola_point, parabola_slope

   !> 1: the outward normal is the direction of travel turned by +90 degrees; -1: by -90 degrees.
   !> The only place where this convention of the deck is written.
   real(wp), parameter :: outward_side = 1.0_wp

   !> Two segments whose directions differ by less (sine) meet smoothly.
   real(wp), parameter :: smooth_angle = 1.0e-6_wp

   type :: segment_kinds
      integer :: line = 1, arc = 2, parabola = 3
   end type segment_kinds
   type(segment_kinds), parameter :: segment_kind = segment_kinds()

   !> A data line of the deck: START x y, LINE x y, CIRCL x y xc yc, PARAB xm ym xe ye.
   type :: segment_card_type
      character(len=8) :: word = ' '
      real(wp) :: value(4) = 0.0_wp    !! in the order of the card [length]
      type(location_type) :: at = nowhere
   end type segment_card_type

   type :: segment_type
      integer :: kind = 1
      real(wp) :: a(2) = 0.0_wp        !! first end [length]
      real(wp) :: b(2) = 0.0_wp        !! last end [length]
      real(wp) :: c(2) = 0.0_wp !! centre of an arc; point at mid-parameter of a parabola [length]
      real(wp) :: radius = 0.0_wp      !! of an arc [length]
      real(wp) :: turn = 0.0_wp        !! of an arc: 1 counterclockwise, -1 clockwise
      real(wp) :: ta(2) = 0.0_wp       !! unit direction of travel at a
      real(wp) :: tb(2) = 0.0_wp       !! the same at b
   end type segment_type

   type :: profile_type
      type(segment_type), allocatable :: segment(:)
      logical :: closed = .false.      !! the last end is the first
      real(wp) :: size = 1.0_wp        !! diagonal of the box of all ends [length]
   end type profile_type

contains

   !> A profile of lines and arcs; an error if they do not join.
   subroutine new_profile(self, cards, fillet, error)
      type(profile_type), intent(out) :: self
      type(segment_card_type), intent(in) :: cards(:)   !! START first
      real(wp), intent(in) :: fillet !! radius at the corners; 0: leave them sharp [length]
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n
      real(wp) :: start(2), low(2), high(2)

      n = size(cards) - 1
      if (n < 1) then
         call raise(error, error_code%deck, 'E0314', &
            & 'a profile needs START and at least one segment')
         return
      end if
      if (cards(1)%word /= 'START') then
         call raise(error, error_code%deck, 'E0314', "a profile begins with START, not with '" &
            & //trim(cards(1)%word)//"'", cards(1)%at)
         return
      end if
      allocate (self%segment(n))
      start = cards(1)%value(:2)
      low = start
      high = start
      do i = 1, n
         call read_segment(self%segment(i), start, cards(i + 1), error)
         if (allocated(error)) return
         start = self%segment(i)%b
         low = min(low, start)
         high = max(high, start)
      end do
      self%size = norm2(high - low)
      self%closed = norm2(start - self%segment(1)%a) <= coincidence*self%size
      if (fillet > 0.0_wp) call round_corners(self, fillet, cards(1)%at, error)
   end subroutine new_profile

   subroutine read_segment(segment, start, card, error)
      type(segment_type), intent(out) :: segment
      real(wp), intent(in) :: start(2)
      type(segment_card_type), intent(in) :: card
      type(error_type), allocatable, intent(out) :: error

      segment%a = start
      select case (card%word)
      case ('LINE')
         segment%b = card%value(1:2)
         call new_line(segment)
      case ('CIRCL')
         segment%kind = segment_kind%arc
         segment%b = card%value(1:2)
         segment%c = card%value(3:4)
         call new_arc(segment, card%at, error)
      case ('PARAB')
         segment%kind = segment_kind%parabola
         segment%c = card%value(1:2)
         segment%b = card%value(3:4)
         segment%ta = parabola_slope(segment, -1.0_wp)
         segment%tb = parabola_slope(segment, 1.0_wp)
      case default
         call raise(error, error_code%deck, 'E0314', &
            & "'"//trim(card%word)//"' is not a segment of a profile", &
            & card%at, help='segments are LINE, CIRCL and PARAB')
      end select
      if (allocated(error)) return
      if (.not. (norm2(segment%b - start) > 0.0_wp .and. norm2(segment%ta) > 0.0_wp &
         & .and. norm2(segment%tb) > 0.0_wp)) then
         call raise(error, error_code%deck, 'E0314', &
            & 'a segment '//trim(card%word)//' of a profile has no length', &
            & card%at)
         return
      end if
      segment%ta = segment%ta/norm2(segment%ta)
      segment%tb = segment%tb/norm2(segment%tb)
   end subroutine read_segment

   pure subroutine new_line(segment)
      type(segment_type), intent(inout) :: segment

      segment%kind = segment_kind%line
      segment%ta = segment%b - segment%a
      segment%tb = segment%ta
   end subroutine new_line

   !> The centre of the deck has few digits: it is moved to the nearest point equally far from both
   !> ends.
   subroutine new_arc(segment, at, error)
      type(segment_type), intent(inout) :: segment   !! a, b and c are given
      type(location_type), intent(in) :: at
      type(error_type), allocatable, intent(out) :: error
      real(wp), parameter :: slack = 1.0e-2_wp   !! of the radius
      real(wp) :: ra, rb, chord(2), swept
      character(len=100) :: value

      ra = norm2(segment%a - segment%c)
      rb = norm2(segment%b - segment%c)
      if (.not. abs(ra - rb) <= slack*max(ra, rb) .or. .not. ra > 0.0_wp) then
         write (value, '("its ends are ",g0.6," and ",g0.6," from its centre")') ra, rb
         call raise(error, error_code%deck, 'E0314', &
            & 'a CIRCL of a profile is no arc: '//trim(value), at, &
            & help='CIRCL, x and y of the end, x and y of the centre')
         return
      end if
      chord = segment%b - segment%a
      if (.not. norm2(chord) > 0.0_wp) return
      segment%c = segment%c + chord*dot_product(0.5_wp*(segment%a + segment%b) - segment%c, chord) &
         & /dot_product(chord, chord)
      segment%radius = norm2(segment%a - segment%c)
      swept = cross_2d(segment%a - segment%c, segment%b - segment%c)
      if (abs(swept) <= smooth_angle*segment%radius**2) then
         call raise(error, error_code%deck, 'E0314', &
            & 'an arc of 180 degrees does not say which way it turns', at, &
            & help='give it as two arcs')
         return
      end if
      segment%turn = sign(1.0_wp, swept)
      segment%ta = segment%turn*left_of(segment%a - segment%c)
      segment%tb = segment%turn*left_of(segment%b - segment%c)
   end subroutine new_arc

   !> Put an arc tangent to both neighbours into every corner.
   subroutine round_corners(self, fillet, at, error)
      type(profile_type), intent(inout) :: self
      real(wp), intent(in) :: fillet                 !! > 0 [length]
      type(location_type), intent(in) :: at
      type(error_type), allocatable, intent(out) :: error
      type(segment_type), allocatable :: rounded(:)
      type(segment_type) :: arc, next
      integer :: i, n, m

      n = size(self%segment)
      allocate (rounded(2*n))
      rounded(1) = self%segment(1)
      m = 1
      do i = 2, n
         next = self%segment(i)
         if (is_corner(rounded(m), next)) then
            call fit_fillet(rounded(m), next, fillet, at, arc, error)
            if (allocated(error)) return
            m = m + 1
            rounded(m) = arc
         end if
         m = m + 1
         rounded(m) = next
      end do
      if (self%closed .and. n > 1) then
         if (is_corner(rounded(m), rounded(1))) then
            call fit_fillet(rounded(m), rounded(1), fillet, at, arc, error)
            if (allocated(error)) return
            m = m + 1
            rounded(m) = arc
         end if
      end if
      self%segment = rounded(:m)
   end subroutine round_corners

   !> Shorten two neighbours and make the arc between them.
   !>
   !> The centre of the arc is where the two carriers, moved by the radius towards the inside of the
   !> turn, meet: the nearest such point to the corner.
   subroutine fit_fillet(one, two, fillet, at, arc, error)
      type(segment_type), intent(inout) :: one, two
      real(wp), intent(in) :: fillet                 !! > 0 [length]
      type(location_type), intent(in) :: at
      type(segment_type), intent(out) :: arc
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: turn, centre(2), p(2), q(2)
      logical :: ok
      character(len=160) :: value

      turn = sign(1.0_wp, cross_2d(one%tb, two%ta))
      ok = one%kind /= segment_kind%parabola .and. two%kind /= segment_kind%parabola
      if (ok) call meet_offset(one, two, turn*fillet, one%b, centre, ok)
      if (ok) then
         p = on_carrier(one, centre)
         q = on_carrier(two, centre)
         ok = lies_on(one, p) .and. lies_on(two, q)
      end if
      if (.not. ok) then
         write (value, &
            & '("FILLET RADIUS=",g0.6," does not fit the corner at (",g0.6,", ",g0.6,")")') &
            & fillet, one%b
         call raise(error, error_code%deck, 'E0314', trim(value), at, &
            & help='take a smaller radius, or leave the corner sharp (no fillet beside PARAB)')
         return
      end if
      arc%kind = segment_kind%arc
      arc%a = p
      arc%b = q
      arc%c = centre
      arc%radius = fillet
      arc%turn = turn
      arc%ta = turn*left_of(p - centre)/fillet
      arc%tb = turn*left_of(q - centre)/fillet
      one%b = p
      one%tb = arc%ta
      two%a = q
      two%ta = arc%tb
   end subroutine fit_fillet

   !> Where the carriers of two segments, moved to their left by `offset`, meet nearest to a point.
   pure subroutine meet_offset(one, two, offset, near, centre, ok)
      type(segment_type), intent(in) :: one, two
      real(wp), intent(in) :: offset, near(2)
      real(wp), intent(out) :: centre(2)
      logical, intent(out) :: ok
      real(wp) :: from(2), along(2), r1, r2, d, h, foot(2)

      centre = 0.0_wp
      if (one%kind == segment_kind%arc .and. two%kind == segment_kind%arc) then
         r1 = one%radius - one%turn*offset
         r2 = two%radius - two%turn*offset
         along = two%c - one%c
         d = norm2(along)
         ok = r1 > 0.0_wp .and. r2 > 0.0_wp .and. d > 0.0_wp
         if (.not. ok) return
         along = along/d
         h = 0.5_wp*(d + (r1 - r2)*(r1 + r2)/d)
         foot = one%c + h*along
         along = left_of(along)
         h = (r1 - h)*(r1 + h)
      else if (one%kind == segment_kind%arc .or. two%kind == segment_kind%arc) then
         if (one%kind == segment_kind%line) then
            along = one%tb
            from = one%b + offset*left_of(along)
            r1 = two%radius - two%turn*offset
            foot = from + along*dot_product(two%c - from, along)
            d = norm2(foot - two%c)
         else
            along = two%ta
            from = two%a + offset*left_of(along)
            r1 = one%radius - one%turn*offset
            foot = from + along*dot_product(one%c - from, along)
            d = norm2(foot - one%c)
         end if
         ok = r1 > 0.0_wp
         h = (r1 - d)*(r1 + d)
      else
         ok = abs(cross_2d(one%tb, two%ta)) > smooth_angle
         if (.not. ok) return
         from = one%b + offset*left_of(one%tb)
         foot = two%a + offset*left_of(two%ta)
         centre = from + one%tb*cross_2d(foot - from, two%ta)/cross_2d(one%tb, two%ta)
         return
      end if
      ok = ok .and. h >= 0.0_wp
      if (.not. ok) return
      h = sqrt(h)
      if (dot_product(near - foot, along) < 0.0_wp) h = -h
      centre = foot + h*along
   end subroutine meet_offset

   !> Closest point of the unbounded line or the full circle that carries a segment.
   pure function on_carrier(segment, p) result(q)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: p(2)
      real(wp) :: q(2)

      if (segment%kind == segment_kind%arc) then
         q = segment%c + segment%radius*(p - segment%c)/norm2(p - segment%c)
      else
         q = segment%a + segment%ta*dot_product(p - segment%a, segment%ta)
      end if
   end function on_carrier

   !> Whether a point of the carrier is strictly between the ends.
   pure logical function lies_on(segment, q)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: q(2)
      real(wp) :: slack

      slack = coincidence*norm2(segment%b - segment%a)
      lies_on = dot_product(q - segment%a, segment%ta) > slack .and. dot_product(segment%b - q, &
         & segment%tb) > slack
   end function lies_on

   pure logical function is_corner(one, two)
      type(segment_type), intent(in) :: one, two

      is_corner = abs(cross_2d(one%tb, two%ta)) > smooth_angle .or. dot_product(one%tb, &
         & two%ta) < 0.0_wp
   end function is_corner

   !> Place on a parabola [length].
   pure function parabola_point(segment, t) result(p)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: t   !! in [-1, 1]
      real(wp) :: p(2)

      p = segment%c + 0.5_wp*t*(segment%b - segment%a) &
         & + t*t*(0.5_wp*(segment%a + segment%b) - segment%c)
   end function parabola_point

   !> d point/d t, not of unit length.
   pure function parabola_slope(segment, t) result(s)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: t   !! in [-1, 1]
      real(wp) :: s(2)

      s = 0.5_wp*(segment%b - segment%a) + 2.0_wp*t*(0.5_wp*(segment%a + segment%b) - segment%c)
   end function parabola_slope

   !> Normal to the left of a direction.
   pure function left_of(t) result(n)
      real(wp), intent(in) :: t(2)
      real(wp) :: n(2)
      n = [-t(2), t(1)]
   end function left_of

   !> Third component of the vector product.
   pure real(wp) function cross_2d(a, b)
      real(wp), intent(in) :: a(2), b(2)
      cross_2d = a(1)*b(2) - a(2)*b(1)
   end function cross_2d
end module lopin_profile
