!> Areas of the slave nodes where they are now, and how bounds of shear follow them.
!>
!> Tractions count on the area at the start of the increment; m k, TAUMAX and the law of Norton and
!> Hoff are stresses on the area now. The ratio of the two and its slopes in the places of the nodes
!> around go into the law of friction (growth of lopin_friction). Surface to surface has the
!> area now in its rows.
module lopin_slave_areas
   use lopin_kinds, only : wp
   use lopin_carried_force, only : find_pieces, piece_areas
   use lopin_facets, only : facets_type, middle_share
   use lopin_area_slopes, only : weight_slopes
   use lopin_friction, only : bounds_by_area
   use lopin_model, only : model_type
   use lopin_flat_elements, only : is_ring
   use lopin_master_surfaces, only : areas_of
   use lopin_nonlinear_contact, only : nonlinear_contact_type, star_type
   implicit none
   private
   public :: areas_now, pieces_now, follow_areas, find_growth, find_growth_slopes

contains

   !> Areas of all points now; those of the start where strains are small by assumption.
   function areas_now(self, model, piece) result(weight)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: piece(:)          !! (n) smooth pieces on sharp edges; 0: all there
      real(wp) :: weight(self%n), area(model%mesh%nnode)
      integer :: pair

      weight = self%first_weight
      if (.not. self%stretches) return
      do pair = 1, size(model%pair)
         if (.not. self%masters%of(pair)%has_slave_faces) cycle
         area = areas_of(self%masters, model, pair)
         where (self%pair == pair .and. self%first_area > 0.0_wp .and. area(self%node) > 0.0_wp) &
            & weight = self%first_weight*(area(self%node)/self%first_area)
         call weigh_pieces(self, pair, piece, weight)
      end do
   end function areas_now

   !> On sharp edges the areas of the pieces that are pressed.
   subroutine weigh_pieces(self, pair, piece, weight)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: pair, piece(:)
      real(wp), intent(inout) :: weight(:)
      integer, allocatable :: at(:)
      real(wp), allocatable :: area(:)
      integer :: i

      if (.not. self%skin(pair)%is_sharp .or. self%skin(pair)%integrated) return
      at = pack([(i, i=1, self%n)], self%pair(:self%n) == pair)
      allocate (area(size(at)))
      call piece_areas(self%skin(pair), self%masters%x, self%node(at), piece(at), area)
      where (area > 0.0_wp) weight(at) = area
   end subroutine weigh_pieces

   !> The smooth pieces of points on sharp edges that face what is opposite now; 0: all there.
   function pieces_now(self, model) result(piece)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer :: piece(self%n), pair, i
      integer, allocatable :: at(:), own(:)
      real(wp), allocatable :: normal(:, :)

      piece = 0
      do pair = 1, size(model%pair)
         if (.not. self%skin(pair)%is_sharp .or. self%skin(pair)%integrated) cycle
         at = pack([(i, i=1, self%n)], self%pair(:self%n) == pair)
         if (allocated(own)) deallocate (own, normal)
         allocate (own(size(at)), normal(model%mesh%ndim, size(at)))
         do i = 1, size(at)
            normal(:, i) = self%opposite(at(i))%normal(:model%mesh%ndim)
         end do
         call find_pieces(self%skin(pair), self%masters%x, self%node(at), normal, &
            & self%opposite(at)%facet > 0, own)
         piece(at) = own
      end do
   end function pieces_now

   !> Tractions of the increment are by the areas that it begins with.
   subroutine follow_areas(self, model)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: i

      self%piece = pieces_now(self, model)
      self%weight = areas_now(self, model, self%piece)
      do i = 1, size(model%pair)
         if (grows(self, i) .and. .not. allocated(self%star(i)%first)) &
            & call new_star(self%star(i), self%masters%of(i)%slave, model%mesh%nnode)
      end do
      do i = 1, self%n
         self%growth(i)%ratio = 1.0_wp
         if (grows(self, self%pair(i)) .or. .not. allocated(self%growth(i)%slope)) cycle
         deallocate (self%growth(i)%dof, self%growth(i)%slope)
      end do
   end subroutine follow_areas

   !> Whether bounds of shear of a pair follow the areas of the slave.
   pure logical function grows(self, pair)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: pair
      grows = self%stretches .and. bounds_by_area(self%friction(pair)) &
         & .and. .not. self%mortar(pair)%is_on .and. self%masters%of(pair)%has_slave_faces
   end function grows

   !> The facets around every node.
   pure subroutine new_star(self, facets, nnode)
      type(star_type), intent(out) :: self
      type(facets_type), intent(in) :: facets
      integer, intent(in) :: nnode
      integer :: next(nnode), i, k, at

      allocate (self%first(nnode + 1), source=0)
      do i = 1, facets%n
         associate (node => facets%node(:facets%nnode(i), i))
            self%first(node + 1) = self%first(node + 1) + 1
         end associate
      end do
      self%first(1) = 1
      do i = 1, nnode
         self%first(i + 1) = self%first(i) + self%first(i + 1)
      end do
      next = self%first(:nnode)
      allocate (self%facet(self%first(nnode + 1) - 1), self%place(self%first(nnode + 1) - 1))
      do i = 1, facets%n
         do k = 1, facets%nnode(i)
            at = next(facets%node(k, i))
            self%facet(at) = i
            self%place(at) = k
            next(facets%node(k, i)) = at + 1
         end do
      end do
   end subroutine new_star

   !> Areas of the points now over those that the increment began with.
   subroutine find_growth(self, model)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp) :: area(model%mesh%nnode), now(self%n)
      integer :: pair, i

      do pair = 1, size(model%pair)
         if (.not. grows(self, pair)) cycle
         area = areas_of(self%masters, model, pair)
         do i = 1, self%n
            if (self%pair(i) /= pair .or. .not. self%first_area(i) > 0.0_wp) cycle
            now(i) = self%first_weight(i)*(area(self%node(i))/self%first_area(i))
         end do
         call weigh_pieces(self, pair, self%piece, now)
         do i = 1, self%n
            if (self%pair(i) /= pair .or. .not. self%first_area(i) > 0.0_wp) cycle
            if (now(i) > 0.0_wp) self%growth(i)%ratio = now(i)/self%weight(i)
         end do
      end do
   end subroutine find_growth

   !> Slopes of the growth of a point in the places of the nodes around it, itself among them.
   subroutine find_growth_slopes(self, model, i)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      integer, allocatable :: node(:)
      real(wp), allocatable :: slope(:, :)
      real(wp) :: own(model%mesh%ndim, 8)
      integer :: a, m, d, n

      d = model%mesh%ndim
      if (.not. grows(self, self%pair(i)) .or. .not. self%first_area(i) > 0.0_wp) return
      associate (star => self%star(self%pair(i)), master => self%masters%of(self%pair(i)), &
         & g => self%growth(i))
         n = 8*(star%first(self%node(i) + 1) - star%first(self%node(i)))
         allocate (node(n), slope(d, n))
         n = 0
         do a = star%first(self%node(i)), star%first(self%node(i) + 1) - 1
            if (self%piece(i) > 0 .and. self%piece(i) /= self%skin(self%pair(i))%piece( &
               & star%facet(a))) cycle
            m = master%slave%nnode(star%facet(a))
            associate (of => master%slave%node(:m, star%facet(a)), &
               & rule => self%masters%rules(master%slave%cell(star%facet(a))), &
               & turned => is_ring(model, model%pair(self%pair(i))%slave))
               call weight_slopes(rule, self%masters%x(:, of), turned, &
                  & middle_share(rule, model%mesh%x(:, of), turned), star%place(a), own(:, :m))
               own(:, :m) = master%thickness(star%facet(a))*own(:, :m)
               call add(of, own(:, :m))
            end associate
         end do
         associate (free => reshape(self%dofs%id(:d, node(:n)), [d*n]))
            g%dof = pack(free, free > 0)
            g%slope = pack(reshape(slope(:, :n), [d*n]), free > 0)
         end associate
         if (self%piece(i) > 0) then
            g%slope = g%slope/self%weight(i)
         else
            g%slope = g%slope*(self%first_weight(i)/(self%first_area(i)*self%weight(i)))
         end if
      end associate

   contains

      !> Slopes of one facet to those of its nodes.
      subroutine add(of, own)
         integer, intent(in) :: of(:)
         real(wp), intent(in) :: own(:, :)
         integer :: k, at

         do k = 1, size(of)
            at = findloc(node(:n), of(k), dim=1)
            if (at == 0) then
               n = n + 1
               at = n
               node(n) = of(k)
               slope(:, n) = 0.0_wp
            end if
            slope(:, at) = slope(:, at) + own(:, k)
         end do
      end subroutine add
   end subroutine find_growth_slopes
end module lopin_slave_areas
