!> Facets of metal that flows which hang past the edge of what presses them, surface to surface.
!>
!> A facet cannot bend at an edge of the other surface. As long as both its ends press, it is held
!> straight past the edge and presses as if it were covered whole; when its end lets go, it tilts,
!> and what is covered presses too little. Of blocks that spread past the corners of dies the force
!> was off by three quarters of the share of the area that hangs, up to 6 %, in both ways.
module lopin_hanging_facets
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_vectors, only : cross
   use lopin_stream, only : stream_type
   use lopin_surface, only : surface_type
   use lopin_model, only : model_type
   use lopin_material_memory, only : strain_at
   use lopin_first_increment, only : first_flow
   use lopin_mortar_element, only : present_mortar_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: hanging_type, measure_hanging, tell_hanging

   !> Of a facet: less of it hangs by rounding. Of the area that presses: told above.
   real(wp), parameter :: rounding = 1.0e-3_wp, told = 0.05_wp
   !> Of an element.
   integer, parameter :: most_faces = 6

   !> The most that has hung in the step so far.
   type :: hanging_type
      real(wp) :: share = 0.0_wp               !! of the area of its pair that presses [-]
      integer :: pair = 0
      integer :: element = 0                   !! whose facet hangs most
      integer :: increment = 0
   contains
      procedure :: keep => keep_hanging
   end type hanging_type

contains

   !> To a stream or back.
   subroutine keep_hanging(self, stream)
      class(hanging_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%share)
      call stream%pass(self%pair)
      call stream%pass(self%element)
      call stream%pass(self%increment)
   end subroutine keep_hanging

   !> Look at an accepted increment.
   subroutine measure_hanging(self, scene, model, increment)
      type(hanging_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: increment         !! its number in the step
      real(wp) :: share
      real(wp), allocatable :: covered(:, :)   !! (faces, elements) by any pair [area]
      integer :: pair, element

      if (.not. (scene%newton%in_use .and. scene%newton%flows)) return
      if (.not. any([(is_looked_at(scene, model, pair), pair=1, size(scene%newton%contact% &
         & mortar))])) return
      allocate (covered(most_faces, model%mesh%nelement), source=0.0_wp)
      associate (c => scene%newton%contact)
         do pair = 1, size(c%mortar)
            if (.not. is_looked_at(scene, model, pair)) cycle
            associate (m => c%mortar(pair))
               associate (status => c%status(m%first:m%first + m%slave%nnode - 1))
                  call add_cover(scene, m, c%masters%of(pair)%surface, status > 0, covered)
               end associate
            end associate
         end do
         do pair = 1, size(c%mortar)
            if (.not. is_looked_at(scene, model, pair)) cycle
            associate (m => c%mortar(pair))
               associate (status => c%status(m%first:m%first + m%slave%nnode - 1))
                  call look(scene, model, m, c%masters%of(pair)%surface, status > 0, covered, &
                     & share, element)
               end associate
            end associate
            if (.not. share > self%share) cycle
            self = hanging_type(share, pair, element, increment)
         end do
      end associate
   end subroutine measure_hanging

   !> A pair of two bodies that is on.
   pure logical function is_looked_at(scene, model, pair) result(is)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      associate (c => scene%newton%contact)
         is = c%mortar(pair)%is_on .and. .not. c%mortar(pair)%tied .and. c%pair_active(pair) &
            & .and. model%pair(pair)%slave /= model%pair(pair)%master
      end associate
   end function is_looked_at

   !> What a pair covers of its facets, where its slave presses.
   subroutine find_cover(scene, mortar, closed, of_slave, of_master)
      type(scene_type), intent(in) :: scene
      type(present_mortar_type), intent(in) :: mortar
      logical, intent(in) :: closed(:)         !! (slave%nnode)
      real(wp), intent(out) :: of_slave(:)     !! (facets) [area]
      real(wp), intent(out) :: of_master(:)
      real(wp) :: part
      integer :: i

      of_slave = 0.0_wp
      of_master = 0.0_wp
      associate (slave => mortar%slave, x => scene%newton%contact%masters%x)
         do i = 1, mortar%list%n
            associate (o => mortar%list%item(i))
               if (.not. any(closed(slave%local(:slave%facets%nnode(o%slave), o%slave)))) cycle
               part = o%part*area_of(slave, o%slave, x, mortar%axisymmetric)
               of_slave(o%slave) = of_slave(o%slave) + part
               of_master(o%master) = of_master(o%master) + part
            end associate
         end do
      end associate
   end subroutine find_cover

   !> What a pair covers, added to what others do: metal may lie under two dies side by side.
   subroutine add_cover(scene, mortar, master, closed, covered)
      type(scene_type), intent(in) :: scene
      type(present_mortar_type), intent(in) :: mortar
      type(surface_type), intent(in) :: master
      logical, intent(in) :: closed(:)         !! (slave%nnode)
      real(wp), intent(inout) :: covered(:, :)
      real(wp) :: of_slave(mortar%slave%facets%n), of_master(master%facets%n)

      call find_cover(scene, mortar, closed, of_slave, of_master)
      call add(mortar%slave, of_slave)
      call add(master, of_master)

   contains

      subroutine add(surface, part)
         type(surface_type), intent(in) :: surface
         real(wp), intent(in) :: part(:)       !! (facets) [area]
         integer :: k

         associate (f => surface%facets)
            do k = 1, size(part)
               if (part(k) > 0.0_wp) covered(f%face(k), f%element(k)) = &
                  & covered(f%face(k), f%element(k)) + part(k)
            end do
         end associate
      end subroutine add
   end subroutine add_cover

   !> The share of one pair: what hangs of facets that press or are pressed, on both sides.
   subroutine look(scene, model, mortar, master, closed, by_any, share, element)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(present_mortar_type), intent(in) :: mortar
      type(surface_type), intent(in) :: master
      logical, intent(in) :: closed(:)         !! (slave%nnode)
      real(wp), intent(in) :: by_any(:, :)     !! (faces, elements) covered by any pair [area]
      real(wp), intent(out) :: share           !! [-]
      integer, intent(out) :: element          !! 0: none hangs
      real(wp) :: of_slave(mortar%slave%facets%n), of_master(master%facets%n)   !! covered [area]
      real(wp) :: hangs, most

      call find_cover(scene, mortar, closed, of_slave, of_master)
      associate (slave => mortar%slave)
         share = 0.0_wp
         element = 0
         if (.not. any(of_slave > 0.0_wp)) return
         hangs = 0.0_wp
         most = 0.0_wp
         call add(slave, of_slave)
         call add(master, of_master)
         share = hangs/sum(of_slave)
      end associate

   contains

      !> Of one side.
      subroutine add(surface, part)
         type(surface_type), intent(in) :: surface
         real(wp), intent(in) :: part(:)       !! (facets) covered [area]
         real(wp) :: whole, under
         integer :: k

         do k = 1, size(part)
            if (.not. part(k) > 0.0_wp) cycle
            whole = area_of(surface, k, scene%newton%contact%masters%x, mortar%axisymmetric)
            associate (f => surface%facets)
               under = max(part(k), by_any(f%face(k), f%element(k)))
            end associate
            if (under > (1.0_wp - rounding)*whole .or. part(k) < rounding*whole) cycle
            if (.not. has_flowed(scene, model, surface%facets%element(k))) cycle
            hangs = hangs + whole - under
            if (whole - under <= most) cycle
            most = whole - under
            element = surface%facets%element(k)
         end do
      end subroutine add
   end subroutine look

   !> Area between the corners of a facet, times the mean radius of a ring [area].
   pure real(wp) function area_of(surface, facet, x, is_ring) result(area)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      logical, intent(in) :: is_ring
      real(wp) :: one(3), two(3)
      integer :: d

      d = size(x, 1)
      one = 0.0_wp
      two = 0.0_wp
      associate (node => surface%facets%node(:, facet), &
         & n => surface%basis%ncorner(surface%facets%cell(facet)))
         one(:d) = x(:, node(2)) - x(:, node(1))
         area = norm2(one)
         if (is_ring) area = 0.5_wp*area*(x(1, node(1)) + x(1, node(2)))
         if (d == 2) return
         if (n == 4) one(:d) = x(:, node(4)) - x(:, node(2))
         two(:d) = x(:, node(3)) - x(:, node(1))
         area = 0.5_wp*norm2(cross(one, two))
      end associate
   end function area_of

   !> An element has flowed by more than a first increment may.
   pure logical function has_flowed(scene, model, e)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      integer :: row

      has_flowed = .false.
      associate (memory => scene%trial%solids, group => scene%solids%group(scene%solids%which(e)))
         associate (p => memory%first(e), q => memory%first(e + 1) - 1)
            if (q < p) return
            row = strain_at(group%element%nstress)
            has_flowed = maxval(memory%value(row, p:q)) > first_flow(model)
         end associate
      end associate
   end function has_flowed

   !> At the end of a step.
   subroutine tell_hanging(self, scene, model)
      type(hanging_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (self%share > told) then
         associate (p => model%pair(self%pair))
            call warn_once(scene%log, 'W0345', 'facets of metal between '// &
               & model%surface(p%slave)%name//' and '//model%surface(p%master)%name// &
               & ' hang past the edge of the other surface, most at element '// &
               & to_text(model%mesh%element_label(self%element))//' in increment '// &
               & to_text(self%increment)//' of step '//to_text(scene%step)//': '// &
               & to_text(100.0_wp*self%share, 2)//' % of the area in contact, and the force '// &
               & 'there may be off by as much', p%at, help='finer facets of the metal that '// &
               & 'spreads, where it meets the edge')
         end associate
      end if
      self = hanging_type()
   end subroutine tell_hanging
end module lopin_hanging_facets
