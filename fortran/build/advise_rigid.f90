!> Advice on meshed masters that are all but rigid.
!>
!> Moduli alone say nothing of a body that bends, or is a skin on something soft. So it is said of
!> bodies of one elastic material that are held behind the contact: behind every facet of the master
!> there is a held node, in a cone of 26 degrees or nearer across than the facet reaches, solid up
!> to there and no deeper than twice the body is wide. Such a column gives way by its depth over its
!> modulus, the slave by no less than its height over its modulus where it cannot spread.
module lopin_advise_rigid
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_model, only : model_type, pair_type, surface_of
   use lopin_friction, only : has_friction
   implicit none
   private
   public :: advise_rigid

   !> A master that gives way by less than a hundredth of what its slave does, and its modulus.
   real(wp), parameter :: all_but_rigid = 100.0_wp
   !> Decks of fewer elements are done before their advice is read.
   integer, parameter :: worth_saying = 200
   !> Facets of a master behind which is looked, and places between each and what holds it.
   integer, parameter :: most_facets = 60, places = 7
   !> Slope of the cone, depth by width.
   real(wp), parameter :: cone = 0.5_wp, slenderest = 2.0_wp

   !> The body of a master.
   type :: backing_type
      logical, allocatable :: element(:)       !! (nelement) that are of it
      logical, allocatable :: node(:)          !! (nnode)
      logical, allocatable :: held(:, :)       !! (ndim, nnode) with all others, in every step
      real(wp), allocatable :: width(:)        !! (ndim) [length]
      !> Boxes around them: (ndim, nelement) [length].
      real(wp), allocatable :: low(:, :), high(:, :)
   end type backing_type

contains

   subroutine advise_rigid(model)
      type(model_type), intent(inout) :: model
      real(wp) :: slave, master, share
      integer :: p, n

      if (allocated(model%transform%node)) then
         if (size(model%transform%node) > 0) return
      end if
      do p = 1, size(model%pair)
         associate (pair => model%pair(p))
            if (pair%tied .or. pair%master == 0 .or. pair%slave == pair%master) cycle
            if (model%surface(pair%master)%kind /= surface_of%faces) cycle
            call stiffness_of(model, pair%slave, slave, n)
            call stiffness_of(model, pair%master, master, n)
            if (.not. slave > 0.0_wp .or. master < all_but_rigid*slave .or. n < worth_saying) cycle
            share = yields(model, pair)
            if (.not. share <= 1.0_wp/all_but_rigid) cycle
            call model%log%say(severity%note, 'N0362', 'master '// &
               & model%surface(pair%master)%name//' is '//to_text(master/slave, 2)// &
               & ' times as stiff as '//model%surface(pair%slave)%name// &
               & ' and held behind the contact: it is all but rigid', &
               & pair%at, help='as a *RIGID BODY it takes no equations ('//to_text(n)// &
               & ' of '//to_text(count(model%mesh%section > 0))//' elements are of its '// &
               & 'material), and the approach changes by about '//to_text(100.0_wp*share, 1)//' %')
         end associate
      end do
   end subroutine advise_rigid

   !> Modulus of the elements behind a surface, 0 if they are of several sections or of rubber; and
   !> how many elements have their section.
   subroutine stiffness_of(model, surface, young, elements)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      real(wp), intent(out) :: young
      integer, intent(out) :: elements
      integer :: section, material

      young = 0.0_wp
      elements = 0
      associate (s => model%surface(surface))
         if (.not. allocated(s%element)) return
         if (size(s%element) == 0) return
         section = model%mesh%section(s%element(1))
         if (section == 0) return
         if (any(model%mesh%section(s%element) /= section)) return
      end associate
      material = model%section(section)%material
      if (material == 0) return
      associate (m => model%material(material))
         if (.not. m%has_elastic) return
         young = m%young
      end associate
      elements = count(model%mesh%section == section)
   end subroutine stiffness_of

   !> How far a master gives way, as a share of what its slave does at the least; huge: not known.
   real(wp) function yields(model, pair) result(share)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair
      type(backing_type) :: backing
      type(cell_type), allocatable :: cell(:)
      real(wp) :: most, more
      integer :: own, other, i
      logical :: rubs

      share = huge(1.0_wp)
      most = 1.0_wp
      own = model%mesh%section(model%surface(pair%slave)%element(1))
      other = model%mesh%section(model%surface(pair%master)%element(1))
      associate (soft => model%material(model%section(own)%material), &
         & stiff => model%material(model%section(other)%material))
         if (stiff%flow%hardening /= 0 .or. stiff%flow%consistency > 0.0_wp &
            & .or. allocated(stiff%plastic) .or. stiff%has_expansion) return
         if (soft%poisson > 0.499_wp) return
         call find_backing(backing, model, pair%master)
         if (any(backing%element .and. model%mesh%section /= other)) return
         rubs = has_friction(model%interaction(pair%interaction)%friction)
         share = soft%young*(1.0_wp - soft%poisson)/((1.0_wp + soft%poisson) &
            & *(1.0_wp - 2.0_wp*soft%poisson))/stiff%young
      end associate
      call cells_of_words(model%element_word, cell)
      associate (s => model%surface(pair%master))
         do i = 1, size(s%element), 1 + size(s%element)/most_facets
            associate (c => cell(model%mesh%etype(s%element(i))))
               if (c%sided) more = huge(1.0_wp)
               if (.not. c%sided) more = depth_behind(model, backing, s%element(i), &
                  & c%face_node(:c%face_nnode(s%face(i)), s%face(i)), [own, merge(1, 0, rubs)])
            end associate
            if (more >= huge(1.0_wp)) share = huge(1.0_wp)
            if (more >= huge(1.0_wp)) return
            most = max(most, more)
         end do
      end associate
      share = share*most
   end function yields

   !> All elements that hang together with a surface, and which of their nodes are held, or moved
   !> alike, in every step.
   subroutine find_backing(self, model, surface)
      type(backing_type), intent(out) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      real(wp) :: value(6, model%mesh%nnode)
      integer :: how(6, model%mesh%nnode), i, k, s

      call flood(self, model, surface)
      allocate (self%held(model%mesh%ndim, model%mesh%nnode))
      do k = 1, model%mesh%ndim
         self%held(k, :) = self%node
      end do
      do s = 1, size(model%step)
         how = -1
         do i = 1, size(model%step(s)%prescribed)
            associate (p => model%step(s)%prescribed(i))
               how(p%dof, p%node) = 2*p%amplitude + merge(1, 0, p%velocity)
               value(p%dof, p%node) = p%value
            end associate
         end do
         do k = 1, model%mesh%ndim
            i = findloc(self%node .and. how(k, :) >= 0, .true., 1)
            if (i == 0) self%held(k, :) = .false.
            if (i == 0) cycle
            self%held(k, :) = self%held(k, :) .and. how(k, :) == how(k, i)
            where (self%held(k, :)) self%held(k, :) = .not. abs(value(k, :) - value(k, i)) > 0.0_wp
         end do
      end do
      self%width = [(maxval(model%mesh%x(k, :), mask=self%node) - minval(model%mesh%x(k, :), &
         & mask=self%node), k=1, model%mesh%ndim)]
      allocate (self%low(model%mesh%ndim, model%mesh%nelement), source=huge(1.0_wp))
      self%high = -self%low
      do i = 1, model%mesh%nelement
         if (.not. self%element(i)) cycle
         associate (x => model%mesh%x(:, pack(model%mesh%conn(:, i), model%mesh%conn(:, i) > 0)))
            self%low(:, i) = minval(x, dim=2)
            self%high(:, i) = maxval(x, dim=2)
         end associate
      end do
   end subroutine find_backing

   subroutine flood(self, model, surface)
      type(backing_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      integer :: e, k, way
      logical :: grown

      allocate (self%element(model%mesh%nelement), self%node(model%mesh%nnode), source=.false.)
      associate (first => model%surface(surface)%element)
         do k = 1, size(first)
            self%element(first(k)) = .true.
            associate (node => model%mesh%conn(:, first(k)))
               self%node(pack(node, node > 0)) = .true.
            end associate
         end do
      end associate
      way = -1
      do
         grown = .false.
         way = -way
         do k = 1, model%mesh%nelement
            e = merge(k, model%mesh%nelement + 1 - k, way > 0)
            if (self%element(e)) cycle
            associate (node => pack(model%mesh%conn(:, e), model%mesh%conn(:, e) > 0))
               if (.not. any(self%node(node))) cycle
               self%node(node) = .true.
            end associate
            self%element(e) = .true.
            grown = .true.
         end do
         if (.not. grown) exit
      end do
   end subroutine flood

   !> Depth of the nearest held node behind a facet, by the height of the slave there if that is
   !> less; huge: there is none, or it is no solid column.
   real(wp) function depth_behind(model, backing, element, face, of) result(depth)
      type(model_type), intent(in) :: model
      type(backing_type), intent(in) :: backing
      integer, intent(in) :: element, face(:)  !! places in the element of the nodes of the facet
      integer, intent(in) :: of(2)             !! section of the slave; 1: it rubs
      real(wp), dimension(model%mesh%ndim) :: middle, inward, y
      real(wp) :: reach, deep, beside, height
      integer :: i, n, nearest

      depth = huge(1.0_wp)
      associate (x => model%mesh%x, own => model%mesh%conn(face, element))
         n = count(model%mesh%conn(:, element) > 0)
         middle = sum(x(:, own), dim=2)/size(own)
         inward = sum(x(:, model%mesh%conn(:n, element)), dim=2)/n - middle
         inward = inward/norm2(inward)
         reach = maxval(norm2(x(:, own) - spread(middle, 2, size(own)), 1))
         nearest = 0
         do i = 1, model%mesh%nnode
            if (.not. backing%node(i)) cycle
            if (.not. all(backing%held(:, i) .or. (abs(inward) < 0.1_wp .and. of(2) == 0))) cycle
            y = x(:, i) - middle
            deep = dot_product(y, inward)
            beside = norm2(y - deep*inward)
            if (deep < -1.0e-6_wp*reach .or. deep >= depth) cycle
            if (beside > max(cone*deep, (1.0_wp + 1.0e-6_wp)*reach)) cycle
            depth = deep
            nearest = i
         end do
         if (nearest == 0) return
         associate (across => pack(backing%width, abs(inward) < maxval(abs(inward))))
            if (size(across) == 0) depth = huge(1.0_wp)
            if (depth > slenderest*minval(across)) depth = huge(1.0_wp)
         end associate
         if (depth < huge(1.0_wp)) then
            if (.not. is_solid(backing, middle, x(:, nearest))) depth = huge(1.0_wp)
         end if
      end associate
      if (depth >= huge(1.0_wp)) return
      height = height_of(model, of(1), inward)
      depth = max(1.0_wp, depth/height)
   end function depth_behind

   !> Places on a line lie in the boxes of elements.
   logical function is_solid(backing, from, to) result(is)
      type(backing_type), intent(in) :: backing
      real(wp), intent(in) :: from(:), to(:)   !! [length]
      real(wp) :: at(size(from), places), room
      logical :: inside(places)
      integer :: e, i

      room = 1.0e-6_wp*maxval(backing%width)
      at = reshape([(from + (to - from)*i/(places + 1.0_wp), i=1, places)], shape(at))
      inside = .false.
      do e = 1, size(backing%element)
         do i = 1, places
            if (.not. inside(i)) inside(i) = all(at(:, i) >= backing%low(:, e) - room &
               & .and. at(:, i) <= backing%high(:, e) + room)
         end do
      end do
      is = all(inside)
   end function is_solid

   !> Extent of the elements of a section along a direction [length].
   real(wp) function height_of(model, section, along) result(height)
      type(model_type), intent(in) :: model
      integer, intent(in) :: section
      real(wp), intent(in) :: along(:)         !! unit
      real(wp) :: least, most, here
      integer :: e, i

      least = huge(1.0_wp)
      most = -huge(1.0_wp)
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) /= section) cycle
         do i = 1, count(model%mesh%conn(:, e) > 0)
            here = dot_product(model%mesh%x(:, model%mesh%conn(i, e)), along)
            least = min(least, here)
            most = max(most, here)
         end do
      end do
      height = most - least
   end function height_of
end module lopin_advise_rigid
